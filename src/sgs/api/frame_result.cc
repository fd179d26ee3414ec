// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/frame_result.h"

#include <algorithm>

#include "sgs/api/internal/convert.h"
#include "sgs/api/internal/to_frame_result.h"

namespace sgs::api {

std::vector<WeakDirection> FrameResult::weak_directions(double threshold) const {
  std::vector<WeakDirection> weak;
  for (std::size_t k = 0; k < spectrum.weights.size(); ++k) {
    if (!(spectrum.weights[k] > threshold)) continue;
    weak.push_back({spectrum.axes[k], spectrum.weights[k], spectrum.snr[k]});
  }
  std::stable_sort(weak.begin(), weak.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return weak;
}

namespace internal {
namespace {

TrackingStatus to_api_status(tracker::TrackingStatus status) {
  switch (status) {
    case tracker::TrackingStatus::kOk:
      return TrackingStatus::kOk;
    case tracker::TrackingStatus::kDegenerate:
      return TrackingStatus::kDegenerate;
    case tracker::TrackingStatus::kLost:
      break;
  }
  return TrackingStatus::kLost;
}

Spectrum to_api_spectrum(const tracker::Diagnostics& diagnostics) {
  Spectrum spectrum;
  spectrum.eigenvalues = diagnostics.eigenvalues;
  spectrum.snr = diagnostics.snr;
  spectrum.weights = diagnostics.weights;
  if (!diagnostics.axes) return spectrum;
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t m = 0; m < 6; ++m) {
      spectrum.axes[k][m] =
          (*diagnostics.axes)(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(k));
    }
  }
  return spectrum;
}

}  // namespace

FrameResult to_frame_result(const slam::FrameRecord& record, const SE3& T_odom_camera) {
  FrameResult result;
  result.index = record.index;
  result.timestamp_s = record.timestamp_s;
  result.status = to_api_status(record.status);
  result.lost_reason = to_string(record.lost_reason);
  result.T_world_camera = to_api(T_odom_camera);
  result.spectrum = to_api_spectrum(record.diagnostics);
  result.prior_active = record.diagnostics.prior_active;
  result.mapping_keyframe = record.mapping_keyframe;
  result.heldout = record.heldout;
  result.inliers = record.diagnostics.inliers;
  result.visual_inliers = record.diagnostics.visual_inliers;
  result.overlap = record.diagnostics.overlap;
  result.gaussians = record.gaussians;
  result.loops = record.loops;
  result.correction_m = record.correction_m;
  result.track_ms = record.track_ms;
  return result;
}

}  // namespace internal
}  // namespace sgs::api
