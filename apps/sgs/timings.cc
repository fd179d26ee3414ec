// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "timings.h"

#include <sys/resource.h>

#include <nlohmann/json.hpp>
#include <numeric>

namespace sgs::app {

std::string timings_json(const StageTimes& times) {
  nlohmann::ordered_json json;
  for (const auto& [name, values] : times.stages()) {
    json[name] = {{"calls", values.size()},
                  {"total_ms", std::accumulate(values.begin(), values.end(), 0.0)},
                  {"p50_ms", quantile(values, 0.5)},
                  {"p95_ms", quantile(values, 0.95)}};
  }
  return json.dump(2) + "\n";
}

std::int64_t peak_rss_bytes() {
  rusage usage{};
  constexpr std::int64_t kKiB = 1024;
  return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss * kKiB : 0;
}

}  // namespace sgs::app
