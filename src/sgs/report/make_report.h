// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sgs/report/report_data.h"
#include "sgs/run/score.h"
#include "sgs/runfolder/run.h"

namespace sgs::report {

/// Everything the report shows about a run.
ReportData make_report(const run::Run& run, const run::Scores& scores);

/// The report of a run read back from its folder, for drawing only: the trajectory is compared with
/// the truth anew, rendering scores and pictures are those kept in the folder. Needs no recording
/// and writes nothing.
Result<ReportData> load_report(const std::filesystem::path& folder, eval::Association association);

}  // namespace sgs::report
