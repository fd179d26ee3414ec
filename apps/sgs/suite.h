// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/eval/metrics.h"

namespace sgs::app {

/// One sequence of a suite.
struct SuiteSequence {
  std::string name;        ///< column in the table
  std::string scene;       ///< of the generator
  std::string trajectory;  ///< TUM sequence whose motion it flies along, where that is at hand
};

/// One way to run a sequence: a row in the table.
struct SuiteVariant {
  std::string name;
  std::vector<std::string> arguments;  ///< of `sgs run`
};

/// A published result, absolute trajectory error in cm; < 0 = failed, NaN = not reported.
struct PublishedRow {
  std::string system;
  std::vector<std::pair<std::string, double>> ate_cm;  ///< by sequence name
};

/// The synthetic suite (docs/results.md, section 1), optionally along real TUM motion.
const std::vector<SuiteSequence>& tum_synth_suite();
/// What others reached on the real sequences of the same names (docs/results.md, section 1).
const std::vector<PublishedRow>& published_results();
/// The trackers, and the paper's method with its ablations (docs/method.md, section 8).
const std::vector<SuiteVariant>& suite_variants();
/// The variant of that name, or an error that lists the names.
Result<SuiteVariant> find_variant(const std::string& name);

/// Which runs a suite consists of, and how to make them.
struct SuiteOptions {
  std::string output;        ///< folder with one run folder per run; resumable
  std::string trajectories;  ///< folder of TUM sequences whose motion is flown along; may be empty
  std::string cache;         ///< folder that keeps rendered sequences; empty: render in every run
  std::string filter = ".*";
  std::vector<std::string> levels;
  std::vector<SuiteVariant> variants;
  std::vector<int> seeds;
  std::vector<std::string> assignments;  ///< key=value for every run
  int jobs = 1;                          ///< runs at a time
  int frames = 0;                        ///< at most so many per sequence; 0 = all
  bool rendering = false;                ///< also compute the rendering scores
  bool again = false;                    ///< repeat runs that are already done
};

/// Options that all commands over the suite share.
void add_suite_options(CLI::App& sub, SuiteOptions& options);

/// One run of a suite: where it goes and how to make it.
struct SuiteJob {
  std::string sequence, level, variant;
  int seed = 1;
  std::string folder;
  std::vector<std::string> arguments;  ///< of the run
  std::string rendered;                ///< folder of the rendered sequence; empty: none needed
  std::vector<std::string> render_arguments;  ///< that make it, into `rendered` + ".part"
};

/// What came of a suite.
struct SuiteOutcome {
  std::vector<SuiteJob> jobs;  ///< all runs, done or not
  bool failed = false;         ///< whether a run, or the rendering of its sequence, failed

  int exit_code() const;
};

/// Makes the output folder and runs what is missing of the runs whose name
/// SEQUENCE-LEVEL-VARIANT-SEED matches the filter, several at a time. Every run leaves its own
/// folder, so that an interrupted suite goes on where it was. Failed runs are reported on stderr
/// with their last words and left out of tables. Fails where the filter is no regular expression or
/// the folder cannot be made.
Result<SuiteOutcome> run_suite(const SuiteOptions& options);
/// Scores of a run that is done.
Result<eval::Metrics> job_metrics(const SuiteJob& job);

/// "mean (worst)" of the trajectory error in cm over seeds, with the lowest share of frames with a
/// pose within 1 m of the truth when it is not all of them; "-" without runs.
std::string ate_cell(const std::vector<eval::Metrics>& runs);

}  // namespace sgs::app
