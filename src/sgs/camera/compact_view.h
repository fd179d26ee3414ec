// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sgs/camera/rgbd_frame.h"

namespace sgs {

/// A frame as far as an alignment needs it, three bytes a pixel: grey values of 8 bits, depth in
/// steps of a fifth of a millimetre up to 13 m.
class CompactView {
 public:
  CompactView() = default;
  /// Halved `level` times: grey values are averaged, depth is taken at every other pixel.
  explicit CompactView(const RgbdFrame& frame, int level = 0);

  /// What a view at full size consists of.
  struct Parts {
    PinholeCamera camera;
    std::int64_t index = 0;
    double timestamp_s = 0;
    bool all_seen = true;  ///< else a grey value of 0 stands for what was not seen
    Image<std::uint8_t> gray;
    Image<std::uint16_t> depth;  ///< steps of a fifth of a millimetre, 0: none
  };
  /// The view again; the images must have the camera's size.
  explicit CompactView(Parts parts);
  /// Of a view that was not halved.
  Parts parts() const;

  const PinholeCamera& camera() const { return camera_; }
  bool empty() const { return gray_.size() == 0; }
  /// The frame again, without its colours.
  RgbdFrame frame() const;

 private:
  int level_ = 0;
  bool all_seen_ = true;  // else a grey value of 0 stands for what was not seen
  PinholeCamera camera_;
  std::int64_t index_ = 0;
  double timestamp_s_ = 0;
  Image<std::uint8_t> gray_;
  Image<std::uint16_t> depth_;
};

}  // namespace sgs
