// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>
#include <vector>

#include "sgs/input/input.h"
#include "sgs/runfolder/run_config.h"

namespace sgs::benchmarks {

/// The input that a benchmark was given: a recording, or synth:NAME:LEVEL@SEED.
inline run::InputSpec input_of(const std::string& name) {
  run::InputSpec spec;
  const auto at = name.rfind('@');
  spec.input = name.substr(0, at);
  if (at != std::string::npos) spec.synth_seed = std::stoull(name.substr(at + 1));
  return spec;
}

/// Its name in a table.
inline std::string short_name(const std::string& name) { return name.substr(name.rfind('/') + 1); }

/// Prints a header and one or more rows per input; `assignments` are key=value settings. Returns
/// the program's exit code.
inline int print_table(
    const std::string& header, const std::vector<std::string>& inputs,
    const std::vector<std::string>& assignments,
    const std::function<Status(const std::string&, const slam::SessionConfig&)>& judge) {
  run::ConfigSources sources;
  sources.assignments = assignments;
  run::InputSpec none;
  const auto config = run::resolve_config(sources, none);
  if (!config) return fmt::print(stderr, "{}\n", config.error().text()), 2;
  fmt::print("{}", header);
  for (const std::string& input : inputs) {
    if (const auto judged = judge(input, config->session); !judged) {
      fmt::print(stderr, "{}: {}\n", input, judged.error().text());
      return 1;
    }
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace sgs::benchmarks
