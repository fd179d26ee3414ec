// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/report_data.h"

#include <algorithm>
#include <cmath>

namespace sgs::report {

void check_columns(const ReportData& data) {
  const auto check = [](const Column& column, std::size_t size) {
    SGS_CHECK(column.empty() || column.size() == size,
              "a column of the report is not as long as its time");
  };
  const std::size_t frames = data.time_s.size();
  for (const Column* column :
       {&data.error_m, &data.status, &data.mapping_keyframe, &data.track_ms, &data.iterations,
        &data.gaussians, &data.prior_active, &data.condition_number, &data.planarity}) {
    check(*column, frames);
  }
  for (const Column& column : data.weights) check(column, frames);
  for (const Column& column : data.snr) check(column, frames);
  for (const auto& [name, column] : data.stage_ms) check(column, frames);
  check(data.estimate_time_s, data.estimate_m.size());
  check(data.estimate_error_m, data.estimate_m.size());
}

bool has_data(const Column& column) {
  return std::any_of(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
}

Eigen::Vector3d likely_up(const Trajectory& path) {
  constexpr double kIdentity_rad = 0.02, kUpright = 0.3, kLooksDown = -0.7;
  if (path.empty() || path.poses().front().T_world_camera.angle() < kIdentity_rad) {
    return -Eigen::Vector3d::UnitY();
  }
  Eigen::Vector3d up = Eigen::Vector3d::Zero(), ahead = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : path.poses()) {
    up -= pose.T_world_camera.R.col(1);
    ahead += pose.T_world_camera.R.col(2);
  }
  const auto count = static_cast<double>(path.size());
  if (up.z() > kUpright * count || ahead.z() < kLooksDown * count) return Eigen::Vector3d::UnitZ();
  int axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  return (up[axis] < 0 ? -1 : 1) * Eigen::Vector3d::Unit(axis);
}

const std::string& run_name(const ReportData& data) {
  return data.label.empty() ? data.title : data.label;
}

}  // namespace sgs::report
