// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/eval/metrics.h"
#include "sgs/suite/suite.h"

namespace sgs::suite {

/// Which runs of a suite to make, and how.
struct Options {
  std::string output;        ///< folder with one run folder per run; resumable
  std::string trajectories;  ///< folder of TUM sequences whose motion is flown along; may be empty
  std::string cache;         ///< folder that keeps rendered sequences; empty: render in every run
  std::string filter = ".*";
  std::vector<std::string> levels;  ///< sensor levels of scenes; recordings have none
  std::vector<Variant> variants;
  std::vector<int> seeds;
  std::vector<std::string> assignments;  ///< key=value for every run
  int frames = 0;                        ///< at most so many per sequence; 0 = all
  bool rendering = false;                ///< also compute the rendering scores
  std::string lpips_weights = {};        ///< file for LPIPS among them; empty: without
};

/// One run of a suite: where it goes and how to make it.
struct Job {
  std::string sequence;
  std::string level;  ///< "recorded" for recordings
  std::string variant;
  int seed = 1;
  std::filesystem::path folder;               ///< of the run
  std::vector<std::string> arguments;         ///< of `sgs`, but for the folder
  std::filesystem::path rendered;             ///< the rendered sequence; empty: none needed
  std::vector<std::string> render_arguments;  ///< of `sgs`, but for the folder

  /// SEQUENCE-LEVEL-VARIANT-SEED.
  std::string name() const;
  /// Lies in the run's folder until it has ended well: an interrupted run leaves scores too.
  std::filesystem::path unfinished_mark() const;
  /// Where the run and the sequence are made, by their claim's generation, before they are moved to
  /// `folder` and `rendered`: half of one is never mistaken for a whole, and workers of which one
  /// was taken for dead do not disturb each other.
  std::filesystem::path making(int generation) const;
  std::filesystem::path rendering(int generation) const;
  /// What `sgs` is started with to make them in a folder.
  std::vector<std::string> words(const std::filesystem::path& making) const;
  std::vector<std::string> render_words(const std::filesystem::path& rendering) const;
  /// Whether the run has scores and ended well.
  bool is_done() const;
  /// Whether the input is there.
  bool is_rendered() const;
};

/// The runs whose name matches the filter; an error where that is no regular expression.
Result<std::vector<Job>> make_jobs(const Suite& suite, const Options& options);

/// Every `count`-th of the runs, from the `index`-th on: what one of `count` workers makes.
std::vector<Job> shard(const std::vector<Job>& jobs, std::size_t index, std::size_t count);

/// Scores of a run that is done.
Result<eval::Metrics> job_metrics(const Job& job);

}  // namespace sgs::suite
