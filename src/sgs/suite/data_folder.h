// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/suite/suite.h"

namespace sgs::suite {

/// What a folder holds of a benchmark.
struct Findings {
  std::vector<std::string> found;    ///< a line for each: which sequence, where
  std::vector<std::string> missing;  ///< a line for each: which sequence, why, and what to do
};

/// Looks for the sequences of a benchmark (Sequence::folders) in `data`: the folder itself, the
/// folders in it, and those one level deeper. Names are compared without regard to case, and '-',
/// '.', ' ' and '_' are one. Only what looks like a recording counts; an archive of such a name is
/// named with the command that unpacks it. Sequences that are found get their `input`, the others
/// are taken out of `suite`. None found is an error, and so are a benchmark without a folder and a
/// folder without a benchmark; a suite of neither kind is left alone.
Result<Findings> find_recordings(const std::filesystem::path& data, Suite& suite);

}  // namespace sgs::suite
