// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finished_run.h"
#include "frame_table.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/report/report_data.h"

namespace sgs::app {

/// Everything the report shows about a run but its pictures.
report::ReportData make_report(const FinishedRun& run, const FrameTable& table,
                               const eval::TrajectoryMetrics& scores, const eval::Metrics& metrics);

/// Says in words when directions were unobservable and nothing filled them; else "".
std::string degeneracy_note(const eval::Metrics& metrics);

}  // namespace sgs::app
