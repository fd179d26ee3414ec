// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/report_data.h"

#include <algorithm>
#include <cmath>

namespace sgs::report {

void check_columns(const ReportData& data) {
  const auto check = [](const Column& column, std::size_t size) {
    SGS_CHECK(column.empty() || column.size() == size,
              "a column of the report is not as long as what it belongs to");
  };
  check(data.error_m, data.frames.size());
  check(data.estimate_time_s, data.estimate_m.size());
  check(data.estimate_error_m, data.estimate_m.size());
}

Column time_s(const ReportData& data) {
  Column times;
  for (const slam::FrameRecord& frame : data.frames) {
    times.push_back(frame.timestamp_s - data.frames.front().timestamp_s);
  }
  return times;
}

Column status_column(const ReportData& data) {
  Column column;
  constexpr double kBad = 3;
  for (const slam::FrameRecord& frame : data.frames) {
    column.push_back(frame.bad ? kBad : static_cast<double>(frame.status));
  }
  return column;
}

Column axis_column(const ReportData& data, std::array<double, 6> tracker::Diagnostics::*values,
                   std::size_t axis) {
  return column(data, [&](const slam::FrameRecord& r) { return (r.diagnostics.*values)[axis]; });
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
