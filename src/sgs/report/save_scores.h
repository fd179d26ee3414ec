// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/run/score.h"
#include "sgs/runfolder/run.h"

namespace sgs::report {

/// Writes scores, pictures and report into the run's folder; what could not be written is in
/// folder.failures(). Directions that nothing observed are said in the log.
void save_scores(const run::Run& run, const run::Scores& scores, run::RunFolder& folder);

}  // namespace sgs::report
