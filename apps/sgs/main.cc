// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "commands.h"
#include "interrupt.h"
#include "manual.h"
#include "sgs/core/memory_reserve.h"
#include "sgs/core/print.h"
#include "sgs/runfolder/run_state.h"
#include "sgs/runfolder/version.h"
#include "standard_streams.h"

namespace sgs::app {

int exit_code(const Error& error) {
  switch (error.code) {
    case ErrorCode::kInvalidArgument:
      return kExitUsage;
    case ErrorCode::kInterrupted:
      return kExitInterrupted;
    default:
      return kExitFailed;
  }
}

int report(const Error& error) {
  say("sgs: {}\n", error.text());
  return exit_code(error);
}

void note_state(const std::string& folder) {
  const auto state = run::load_state(folder);
  if (!state) return;
  if (const auto sentence = state->sentence(folder); !sentence.empty()) say("sgs: {}\n", sentence);
}

namespace {

/// What was printed may still fail to get to where it was to go. A reader that has seen enough and
/// closed its pipe is no failure.
int close_stdout(int code) {
  if (std::fflush(stdout) != 0) note_output_error();
  const int reason = output_error();
  if (reason == 0 || reason == EPIPE) return code;
  say("sgs: cannot write to standard output: {}\n", std::strerror(reason));
  return code == kExitDone ? kExitFailed : code;
}

/// A stop that nobody asked for is a failure.
int explain_shortage(int code) {
  if (code != kExitInterrupted || !memory_ran_short()) return code;
  say("sgs: the memory was used up, so the work was ended early; what was done is kept (use fewer "
      "or "
      "smaller frames, or lower history.memory_mb)\n");
  return kExitFailed;
}

int parse_and_run(int argc, char** argv) {
  CLI::App app{
      "Spectral GS-SLAM: RGB-D SLAM that builds a photorealistic 3D Gaussian map on an ordinary "
      "CPU"};
  app.name("sgs");
  app.set_version_flag("--version", sgs::run::version());
  app.require_subcommand(1);
  app.fallthrough(false);
  Action action;
  add_run(app, action);
  add_refine(app, action);
  add_calibrate(app, action);
  add_eval(app, action);
  add_render(app, action);
  add_synth(app, action);
  add_convert(app, action);
  add_send(app, action);
  add_camera_test(app, action);
  add_export(app, action);
  add_merge(app, action);
  add_info(app, action);
  add_view(app, action);
  add_bench(app, action);
  add_sweep(app, action);
  add_manual(app, action);
  try {
    install_interrupt_handler();
    app.parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? kExitDone : kExitUsage;
  } catch (...) {
    return report(current_error());
  }
}

}  // namespace
}  // namespace sgs::app

int main(int argc, char** argv) {
  sgs::app::open_standard_streams();
  return sgs::app::close_stdout(sgs::app::explain_shortage(sgs::app::parse_and_run(argc, argv)));
}
