// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "scoring.h"

#include "commands.h"
#include "interrupt.h"
#include "sgs/core/print.h"
#include "terminal_observer.h"

namespace sgs::app {

void add_score_options(CLI::App& sub, run::ScoreOptions& options) {
  sub.add_option("--lpips-weights", options.lpips_weights, "LPIPS-Alex v0.1 weights");
  sub.add_option("--lpips-stride", options.rendering.lpips_stride, "LPIPS on every n-th frame")
      ->check(CLI::PositiveNumber);
}

Result<run::Scores> score_with_progress(const run::Run& run, const run::ScoreOptions& options,
                                        bool quiet) {
  TerminalObserver observer(run.frames_total, quiet);
  auto scores = run::score_run(run, options, observer, stop_token());
  observer.finish();
  if (scores && !scores->no_recording.empty()) say("sgs: {}\n", scores->no_recording);
  return scores;
}

int report_failures(const run::RunFolder& folder) {
  for (const Error& error : folder.failures()) report(error);
  if (!folder.rescued_to().empty()) {
    say("sgs: what did not fit there was kept in {}\n", folder.rescued_to().string());
  }
  return folder.failures().empty() ? kExitDone : kExitFailed;
}

}  // namespace sgs::app
