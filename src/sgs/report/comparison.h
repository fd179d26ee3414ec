// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/eval/metrics.h"
#include "sgs/report/drawings.h"

namespace sgs::report {

/// Positions of the best values of one metric (all that tie); empty where "better" has no meaning,
/// where fewer than two runs measured it, or where all are equal. `label` as in eval::MetricLine.
std::vector<std::size_t> best_runs(const std::string& label,
                                   const std::vector<eval::Metrics>& runs);

/// Lines of config.toml in which the runs differ: key, and one value per run ("" where missing).
struct ConfigDifference {
  std::string key;
  std::vector<std::string> values;
};
std::vector<ConfigDifference> config_differences(const std::vector<std::string>& config_tomls);

/// One page for two or more runs: metrics side by side with the best marked, paths and errors in
/// the same pictures, renderings of the same frames, and where the configurations differ.
std::string comparison_html(Runs runs);
/// Writes comparison_html() atomically.
Status save_comparison(const std::filesystem::path& path, Runs runs);

}  // namespace sgs::report
