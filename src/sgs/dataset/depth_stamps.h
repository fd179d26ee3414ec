// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sgs::dataset {

/// By how much later than its colour the depth of a recording's frames was taken, as stamped.
struct DepthDelays {
  double least_s = 0, median_s = 0, most_s = 0;
};

/// Empty where all are 0: depth has no stamps of its own then.
std::optional<DepthDelays> summarize_delays(std::vector<double> delays_s);

/// Why stamps of depth cannot be believed, in a sentence with the numbers and the remedy; empty
/// where they can. Cameras that pair images take both within a frame or two, so a median beyond 50
/// ms is another clock, and stamps that stand still are no times. `delays_s`, `depth_times_s`: one
/// a frame.
std::optional<std::string> implausible_delays(const std::vector<double>& delays_s,
                                              const std::vector<double>& depth_times_s);

}  // namespace sgs::dataset
