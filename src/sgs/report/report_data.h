// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sgs/camera/depth_calibration.h"
#include "sgs/core/error.h"
#include "sgs/eval/map_statistics.h"
#include "sgs/eval/metrics.h"
#include "sgs/eval/run_evaluator.h"
#include "sgs/geometry/se3.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/slam/frame_record.h"

namespace sgs::report {

/// Values per frame or position; NaN = missing.
using Column = std::vector<double>;

/// Time spent in one stage over the whole run; '/' in names separates levels.
struct StageSummary {
  std::string name;
  std::int64_t calls = 0;
  double total_ms = 0, p50_ms = 0, p95_ms = 0;
};

/// What report.html shows: plain data, so that a report can be made from any run folder.
struct ReportData {
  std::string title;                                       ///< name of the sequence
  std::string subtitle;                                    ///< what was run, one line
  std::string label;                                       ///< short name of the run in comparisons
  std::vector<std::pair<std::string, std::string>> facts;  ///< shown as tags: preset, tracker, ...
  std::vector<std::string> notes;  ///< protocol lines and warnings, in plain text
  eval::Metrics metrics;

  /// Positions in one world; the estimate aligned to the truth where there is one. `truth_m` may
  /// have its own length and may be empty.
  std::vector<Eigen::Vector3d> estimate_m, truth_m;
  Column estimate_time_s;      ///< empty, or per position of the estimate, on the clock of time_s()
  Column estimate_error_m;     ///< empty, or per position of the estimate
  std::vector<SE3> keyframes;  ///< poses in the same world
  std::vector<eval::MapPoint> map_points;  ///< an overview of the map in the same world
  /// Upwards in that world, for top, side and 3-D view; zero: the direction of least motion.
  Eigen::Vector3d up = Eigen::Vector3d::Zero();

  std::vector<slam::FrameRecord> frames;  ///< as in frames.csv
  Column error_m;  ///< aligned translation error, per frame; empty where there is no truth
  std::vector<StageSummary> stages;
  double condition_threshold = 0;  ///< drawn as a line when > 0
  double planarity_threshold = 0;
  bool decides_by_snr = false;  ///< false: by the condition number
  double snr_threshold = 0;     ///< an axis below it is unseen, above twice it seen

  eval::MapStatistics map;
  std::vector<eval::FramePictures> pictures;
  std::optional<DepthCalibration> calibration;  ///< of the depths, where the run used one
  std::string config_toml;
};

/// Seconds from the start of the sequence, per frame.
Column time_s(const ReportData& data);
/// One value of each frame, as `of` takes it from the record; bad frames have none.
template <class Of>
Column column(const ReportData& data, const Of& of) {
  Column values;
  values.reserve(data.frames.size());
  for (const slam::FrameRecord& frame : data.frames) {
    values.push_back(frame.bad ? std::numeric_limits<double>::quiet_NaN()
                               : static_cast<double>(of(frame)));
  }
  return values;
}
/// 0 tracked, 1 degenerate, 2 lost, 3 bad frame.
Column status_column(const ReportData& data);
/// A column of one of the six axes, the least seen first.
Column axis_column(const ReportData& data, std::array<double, 6> tracker::Diagnostics::*values,
                   std::size_t axis);

/// Throws where columns do not have the lengths that their comments ask for.
void check_columns(const ReportData& data);

/// Whether a column holds any value.
bool has_data(const Column& column);

/// Upwards in the world of a camera's path: against y where the world starts at the camera, else z
/// (motion capture, the synthetic scenes, NICE-SLAM's layout) unless the cameras, which are held
/// upright on the whole, contradict that; then the axis that fits them best.
Eigen::Vector3d likely_up(const Trajectory& path);

/// Distinguishes runs in pictures: label, or title where there is none.
const std::string& run_name(const ReportData& data);

}  // namespace sgs::report
