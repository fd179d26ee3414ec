// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sgs/core/image.h"

namespace sgs::stream {

/// Looks at the first frames of a stream for numbers of another unit than docs/stream.md asks for.
/// They have been delivered by then, so it only says so: once for times, once for depth, once for
/// masks.
class UnitDoubts {
 public:
  /// A time as it was sent, of a frame that was used or not. What there is to say of the times.
  std::optional<std::string> of_time(double sent);
  /// Depth as it will be used, metres. What there is to say of its unit.
  std::optional<std::string> of_depth(const DepthImage& depth_m);
  /// A mask as it will be used, 0 where something moves; null: nowhere. What there is to say of
  /// which value means what.
  std::optional<std::string> of_mask(const PixelMask* still);

 private:
  std::vector<double> times_;
  bool times_judged_ = false;
  std::vector<float> medians_m_;
  bool depth_judged_ = false;
  std::vector<float> moving_shares_;
  bool masks_judged_ = false;
};

}  // namespace sgs::stream
