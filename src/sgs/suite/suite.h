// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::suite {

/// One sequence of a suite: a scene of the generator, or a recording.
struct Sequence {
  std::string name;    ///< column in the table
  std::string scene;   ///< of the generator; empty: a recording
  std::string motion;  ///< TUM recording whose path the camera flies along, where that is at hand
  std::string input;   ///< of `sgs run`, for a recording
  std::vector<std::string> folders = {};  ///< names under which a recording is looked for
  std::string needs = {};  ///< file without which a recording that is found is left out
};

/// One way to run a sequence: a row in the table.
struct Variant {
  std::string name;
  std::vector<std::string> arguments;  ///< of `sgs run`
};

/// What a publication reports of a suite's sequences.
struct Publication {
  /// Stands in a row for the mean over all sequences of the suite.
  static constexpr const char* kAverage = "average";

  struct Row {
    std::string system;
    /// Absolute trajectory error in cm by sequence name; empty: lost. Not reported: not in here.
    std::map<std::string, std::optional<double>> ate_cm = {};
    /// Pictures of the map against the camera's, by sequence name.
    std::map<std::string, double> psnr_db = {}, ssim = {}, lpips = {};
    std::optional<double> fps = {};  ///< frames per second, over all sequences
  };
  std::string source;  ///< who, where, which table
  std::vector<Row> results;
};

/// A published set of recordings that whoever has it keeps in a folder.
struct Benchmark {
  std::string name;                   ///< under which it is published, for people
  std::vector<std::string> archives;  ///< names of files that hold several of its sequences
};

/// Sequences, ways to run them, and what others reached.
struct Suite {
  std::string name;
  std::vector<Sequence> sequences;
  std::vector<Variant> variants;
  std::map<std::string, std::string> aliases;  ///< short names of parameters, for sweeps
  std::vector<Publication> publications;
  std::optional<Benchmark> benchmark;  ///< where sequences have `folders`

  /// The variant of that name, or an error that lists the names.
  Result<Variant> variant(const std::string& wanted) const;
};

/// Adds what a TOML text says (docs/suites.md) to `suite`; a variant or alias that is there is
/// replaced. Unknown keys and scenes, wrong types, missing or repeated names and published values
/// without source or sequence are errors with file and line; `source` stands for the file's name.
Status read_suite(std::string_view text, std::string_view source, Suite& suite);

/// A built-in suite, or, where the name ends in ".toml", that of a file; inputs are then relative
/// to the file's folder. The built-in variants and aliases are there in both. An unknown name is an
/// error that lists the built-in suites.
Result<Suite> load_suite(const std::string& name_or_file);

}  // namespace sgs::suite
