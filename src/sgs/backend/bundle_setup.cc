// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/bundle_setup.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sgs/core/error.h"

namespace sgs::backend {
namespace {

constexpr int kFewestPixels = 40;   // per keyframe, below which it is of no use
constexpr double kSameView = 0.45;  // view distance up to which pixels are looked for
constexpr int kOtherPlace = 8;      // keyframes apart that make a view a revisit

/// For each keyframe its neighbours in time and the nearest views from other times.
std::vector<std::vector<int>> choose_targets(const KeyframeList& keyframes,
                                             const CalibrationConfig& config) {
  const auto n = static_cast<int>(keyframes.size());
  std::vector<std::vector<int>> targets(keyframes.size());
  for (int i = 0; i < n; ++i) {
    const PlacedKeyframe& host = keyframes[static_cast<std::size_t>(i)];
    const SE3 T_host_odom = host.T_odom_camera.inverse();
    std::vector<std::pair<double, int>> revisits;
    for (int j = 0; j < n; ++j) {
      if (j == i) continue;
      const double distance = view_distance(
          *host.keyframe, T_host_odom * keyframes[static_cast<std::size_t>(j)].T_odom_camera);
      if (std::abs(i - j) <= config.neighbours) {
        if (distance < 2 * kSameView) targets[static_cast<std::size_t>(i)].push_back(j);
      } else if (std::abs(i - j) >= kOtherPlace && distance < kSameView) {
        revisits.emplace_back(distance, j);
      }
    }
    std::sort(revisits.begin(), revisits.end());
    for (std::size_t k = 0;
         k < std::min(revisits.size(), static_cast<std::size_t>(config.revisits)); ++k) {
      targets[static_cast<std::size_t>(i)].push_back(revisits[k].second);
    }
    std::sort(targets[static_cast<std::size_t>(i)].begin(),
              targets[static_cast<std::size_t>(i)].end());
  }
  return targets;
}

/// As tracked and measured, corrected by what is known already.
BundleState start_of(const KeyframeList& keyframes, int grid_size, const DepthCalibration* known) {
  BundleState state;
  state.offsets_per_m.setZero(grid_size);
  const DepthCalibration none;
  const DepthCalibration& calibration = known != nullptr ? *known : none;
  if (known != nullptr) {
    state.offsets_per_m = Eigen::Map<const Eigen::VectorXd>(calibration.offset_per_m.data(),
                                                            std::ssize(calibration.offset_per_m));
    state.shift_px = calibration.shift_px;
    state.delay_s = calibration.delay_s;
  }
  SGS_CHECK(state.offsets_per_m.size() == grid_size, "an estimate of another grid");
  for (const PlacedKeyframe& k : keyframes) {
    state.T_world_camera.push_back(k.T_odom_camera);
    state.exposures.emplace_back();
    state.readout_turns.push_back(Eigen::Vector3d::Zero());
    auto& depths = state.inverse_depths.emplace_back();
    for (const HostPixel& p : k->pixels) {
      const double corrected = p.inverse_depth + calibration.offset_at(p.u, p.v);
      depths.push_back(corrected > 0 ? corrected : p.inverse_depth);
    }
  }
  return state;
}

}  // namespace

KeyframeList useful_keyframes(const std::vector<Keyframe>& all, const history::Path& path) {
  KeyframeList out;
  for (const Keyframe& k : all) {
    if (static_cast<int>(k.pixels.size()) >= kFewestPixels) out.push_back({&k, path.at(k.frame)});
  }
  return out;
}

KeyframeList thinned(const KeyframeList& keyframes, int most) {
  const auto n = static_cast<int>(keyframes.size());
  if (n <= most) return keyframes;
  KeyframeList out;
  for (int i = 0; i < most; ++i) {
    out.push_back(keyframes[static_cast<std::size_t>(std::int64_t{i} * n / most)]);
  }
  return out;
}

Bundle make_bundle(const KeyframeList& keyframes, double readout_s, const CalibrationConfig& config,
                   const DepthCalibration* known) {
  BundleProblem problem;
  problem.targets = choose_targets(keyframes, config);
  for (const PlacedKeyframe& k : keyframes) problem.keyframes.push_back(k.keyframe);
  problem.readout_s = readout_s;
  problem.grid = {config.columns, config.rows};
  problem.config = config;
  BundleState start = start_of(keyframes, problem.grid.size(), known);
  return Bundle(std::move(problem), std::move(start));
}

}  // namespace sgs::backend
