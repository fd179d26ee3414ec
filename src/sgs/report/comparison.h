// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/report/drawings.h"

namespace sgs::report {

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
