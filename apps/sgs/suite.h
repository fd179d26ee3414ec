// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::app {

/// One sequence of a suite.
struct SuiteSequence {
  std::string name;        ///< row in the table
  std::string scene;       ///< of the generator
  std::string trajectory;  ///< TUM sequence whose motion it flies along, where that is at hand
};

/// A published result, absolute trajectory error in cm; < 0 = failed, NaN = not reported.
struct PublishedRow {
  std::string system;
  std::vector<std::pair<std::string, double>> ate_cm;  ///< by sequence name
};

/// The synthetic suite of EVALUATION section 4, optionally along real TUM motion.
const std::vector<SuiteSequence>& tum_synth_suite();
/// What others reached on the real sequences of the same names (EVALUATION section 5).
const std::vector<PublishedRow>& published_results();

/// One run of a suite: where it goes and how to make it.
struct SuiteJob {
  std::string sequence, level, variant;  ///< variant: tracker and preset, the table's row
  int seed = 1;
  std::string folder;
  std::vector<std::string> arguments;  ///< of `sgs run`
};

/// Runs a program and waits for it; output goes to `log_file`. Returns the exit code.
Result<int> run_program(const std::vector<std::string>& arguments, const std::string& log_file);

}  // namespace sgs::app
