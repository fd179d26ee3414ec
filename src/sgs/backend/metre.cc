// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/metre.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sgs::backend {
namespace {

constexpr double kContradiction = 0.015;        // of the path's length
constexpr double kContradictionDepth = 0.0075;  // of depth itself

double mean_depth_m(const std::vector<Keyframe>& keyframes) {
  double sum = 0;
  for (const Keyframe& k : keyframes) sum += k.mean_depth_m;
  return sum / static_cast<double>(std::max<std::size_t>(1, keyframes.size()));
}

}  // namespace

double scale_of(const std::vector<MovedPose>& poses) {
  Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = Eigen::Vector3d::Zero();
  for (const MovedPose& p : poses) {
    before += p.before.t / static_cast<double>(poses.size());
    after += p.after.t / static_cast<double>(poses.size());
  }
  double square = 0, product = 0;
  for (const MovedPose& p : poses) {
    square += (p.before.t - before).squaredNorm();
    product += (p.before.t - before).dot(p.after.t - after);
  }
  return square > 0 ? product / square : 1;
}

double mean_depth_share(const DepthCalibration& calibration, const std::vector<Keyframe>& seen) {
  return std::abs(calibration.mean_offset_per_m()) * mean_depth_m(seen);
}

double rms_depth_share(const DepthCalibration& calibration, const std::vector<Keyframe>& seen) {
  const std::vector<double> area = calibration.grid.area();
  double square = 0;
  for (std::size_t k = 0; k < area.size(); ++k) {
    square += area[k] * calibration.offset_per_m[k] * calibration.offset_per_m[k];
  }
  return std::sqrt(square) * mean_depth_m(seen);
}

std::optional<std::string> metre_contradiction(const DepthEstimate& estimate, double scale,
                                               double share) {
  const double off = std::abs(scale - 1);
  if (off <= kContradiction || share <= kContradictionDepth) return {};
  return fmt::format(
      "pictures and depth disagree on the metre by {:.1f} % ({} keyframes, an offset of {:+.4f} "
      "/m): the intrinsics or the registration of the two cameras are probably wrong",
      100 * off, estimate.keyframes, estimate.calibration.mean_offset_per_m());
}

}  // namespace sgs::backend
