// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/eval/metrics.h"
#include "sgs/eval/run_evaluator.h"

namespace sgs::eval {

/// Values per frame; NaN = missing. A column is either empty (not shown) or as long as `time_s`.
using Column = std::vector<double>;

/// What report.html shows: plain data, so that a report can be made from any run folder.
struct ReportData {
  std::string title;                                       ///< name of the sequence
  std::string subtitle;                                    ///< what was run, one line
  std::vector<std::pair<std::string, std::string>> facts;  ///< shown as tags: preset, tracker, ...
  std::vector<std::string> notes;  ///< protocol lines and warnings, in plain text
  Metrics metrics;
  /// Further runs for a comparison table (name, metrics), this run not included.
  std::vector<std::pair<std::string, Metrics>> others;

  /// Positions in one world; the estimate aligned to the truth where there is one. `truth_m` may
  /// have its own length and may be empty.
  std::vector<Eigen::Vector3d> estimate_m, truth_m;
  /// Roughly upwards in that world, for top and side view; zero: the direction of least motion.
  Eigen::Vector3d up = Eigen::Vector3d::Zero();

  Column time_s;   ///< from the start of the sequence
  Column error_m;  ///< aligned translation error
  Column status;   ///< 0 tracked, 1 degenerate, 2 lost, 3 bad frame
  Column track_ms, iterations, gaussians;
  Column fps;           ///< smoothed system rate
  Column prior_active;  ///< 0 or 1
  Column condition_number;
  Column planarity;
  double condition_threshold = 0;  ///< drawn as a line when > 0
  double planarity_threshold = 0;
  std::array<Column, 6> weights;  ///< 0 seen .. 1 unseen, by principal axis

  std::vector<FramePictures> pictures;
  std::string config_toml;
};

/// The whole page as one HTML document without any outside address.
std::string report_html(const ReportData& data);
/// Writes report_html() atomically.
Status save_report(const std::filesystem::path& path, const ReportData& data);

}  // namespace sgs::eval
