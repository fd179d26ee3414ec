// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

#include "sgs/report/plot/canvas.h"
#include "sgs/report/plot/plot.h"
#include "sgs/report/report_data.h"

namespace sgs::report {

/// One run as the drawings see it: several runs are drawn into one picture.
using Runs = std::span<const ReportData>;

// The report's drawings. Each list holds only drawings that have something to show. With one run
// its own colours tell the story, with several each run has a colour of the palette.

/// Seen from above and from the side; error along the path (one run) or paths against truth.
std::vector<Drawing> trajectory_drawings(Runs runs);
/// Translation error over time with the tracking status.
std::vector<Drawing> error_drawings(Runs runs);
/// The paper's three rows; the weights of the six axes; their signal-to-noise ratios.
std::vector<Drawing> degeneracy_drawings(const ReportData& data);
/// Stages of the run, parts of tracking per frame.
std::vector<Drawing> timing_drawings(const ReportData& data);
/// Growth of the map, opacities and sizes of its Gaussians.
std::vector<Drawing> map_drawings(const ReportData& data);
/// The depth calibration that the run used, and how well it is known.
std::vector<Drawing> calibration_drawings(const ReportData& data);

/// Every column of frames.csv that is a number and varies, over time.
std::vector<Drawing> value_drawings(const ReportData& data);

/// All drawings of one run (or, for several, those that compare them).
std::vector<Drawing> all_drawings(Runs runs);
/// Writes each as NAME.svg with its style inside; returns the files.
Result<std::vector<std::filesystem::path>> save_drawings(const std::filesystem::path& folder,
                                                         const std::vector<Drawing>& drawings);

/// Directions on the page for looking at a world: `up` is towards the reader in the top view and
/// upwards in the side view; `across` is the longer horizontal direction. They are axes of the
/// world, unless its up is far from all of them.
struct Views {
  Eigen::Vector3d across, away, up;
  std::string across_name, away_name, up_name;  ///< axis labels, metres
};
Views choose_views(Runs runs);

}  // namespace sgs::report
