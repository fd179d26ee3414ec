// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/save_scores.h"

#include "sgs/core/log.h"
#include "sgs/report/make_report.h"
#include "sgs/report/report.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::report {

void save_scores(const run::Run& run, const run::Scores& scores, run::RunFolder& folder) {
  namespace fs = std::filesystem;
  if (const auto note = run::degeneracy_note(scores.metrics); !note.empty()) log().warn("{}", note);
  folder.save(run::files::kMetrics,
              [&](const fs::path& path) { return eval::save_metrics(path, scores.metrics); });
  if (scores.rendering) run::save_pictures(scores.rendering->pictures, folder);
  ReportData data = make_report(run, scores);
  // Those that the folder has belong to the scores that were kept.
  if (!scores.no_recording.empty()) data.pictures = run::load_pictures(folder.path());
  folder.save(run::files::kReport, [&](const fs::path& path) { return save_report(path, data); });
}

}  // namespace sgs::report
