// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "sgs/api/export.h"
#include "sgs/api/stop.h"
#include "sgs/api/types.h"

namespace sgs::api {

/// One score (docs/metrics.md).
struct Metric {
  std::string key;   ///< as in metrics.json
  std::string unit;  ///< that people read it in; `value` is in the unit that the key names
  std::string meaning;
  /// std::monostate: not measured.
  std::variant<std::monostate, std::int64_t, double, std::string> value;
};
using Metrics = std::vector<Metric>;

/// Compares a trajectory with the truth after a rigid alignment: ate_rmse_m and the rest of the
/// group "Trajectory". `association` says how poses find each other: "interpolate", "nearest" or
/// "nice-slam". Throws kInvalidArgument for other words and for trajectories that cannot be.
SGS_API Metrics evaluate(const Trajectory& estimate, const Trajectory& truth,
                         const std::string& association = "interpolate");

/// How to score a run folder.
struct EvaluateOptions {
  std::string association = "interpolate";
  /// Compare the map with the recording. Where that is gone, scores of pictures that the folder has
  /// stay, and the metric `pictures` says "kept".
  bool pictures = true;
  std::string lpips_weights;  ///< file; empty = LPIPS is not measured
  int threads = 2;
};
/// Scores a run folder as `sgs eval` does; writes nothing. Throws kInterrupted after a stop.
SGS_API Metrics evaluate_run(const std::string& folder,
                             const EvaluateOptions& options = EvaluateOptions(),
                             const Stop& stop = Stop());

}  // namespace sgs::api
