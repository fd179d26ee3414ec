// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

namespace sgs::capture {

/// An image as a camera's library gave it.
struct CameraImage {
  enum class Kind { kColor, kDepth };
  Kind kind = Kind::kColor;
  int domain = 0;       ///< whose clock stamped it
  double stamp_s = 0;   ///< by that clock; later by one clock for all
  double host_s = 0;    ///< when it came, by a steady clock
  double system_s = 0;  ///< the same, since 1970
  std::optional<double> exposure_s, gain;
  std::string bytes;  ///< rows without gaps: rgb8, or 16-bit depth
};

struct ImagePair {
  CameraImage color, depth;
};

/// Pairs each depth image with the colour image nearest to it in time, each of which is used once.
/// Where one of them comes more often, the others are left out.
class ImagePairs {
 public:
  /// `period_s`: between colour images; `most_s`: what is farther apart is no pair.
  ImagePairs(double period_s, double most_s) : period_s_(period_s), most_s_(most_s) {}

  void add(CameraImage image);
  /// The next pair, as soon as no image that may still come can be nearer.
  std::optional<ImagePair> next();
  /// Depth images without a partner.
  std::int64_t alone() const { return alone_; }

 private:
  std::deque<CameraImage> color_, depth_;
  double period_s_, most_s_;
  std::int64_t alone_ = 0;
};

}  // namespace sgs::capture
