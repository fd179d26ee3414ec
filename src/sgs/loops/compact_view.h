// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sgs/camera/rgbd_frame.h"

namespace sgs::loops {

/// A frame as far as an alignment needs it, three bytes a pixel: grey values of 8 bits, depth in
/// steps of a fifth of a millimetre up to 13 m.
class CompactView {
 public:
  CompactView() = default;
  explicit CompactView(const RgbdFrame& frame);

  const PinholeCamera& camera() const { return camera_; }
  /// The frame again, without its colours.
  RgbdFrame frame() const;

 private:
  PinholeCamera camera_;
  std::int64_t index_ = 0;
  double timestamp_s_ = 0;
  Image<std::uint8_t> gray_;
  Image<std::uint16_t> depth_;
};

}  // namespace sgs::loops
