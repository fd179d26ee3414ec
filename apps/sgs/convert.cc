// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/convert.h"

#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "input_options.h"
#include "interrupt.h"
#include "log_setup.h"
#include "progress.h"
#include "sgs/core/print.h"

namespace sgs::app {
namespace {

struct ConvertCommand {
  run::InputSpec input;
  std::string folder;
  int threads = 2;
  bool jpeg = false, quiet = false;
};

int run_convert(const ConvertCommand& command) {
  setup_logging({}, command.quiet);
  auto input = run::open_input(command.input, command.threads);
  if (!input) return report(input.error());
  Progress progress("frames", input->source->size(), command.quiet);
  const auto step = [&] { progress.step(""); };
  const auto done = run::convert(*input, command.folder, command.jpeg, step, stop_token());
  progress.finish();
  if (!done) return report(done.error());
  if (done->bad > 0) say("sgs: {} frames could not be read and were left out\n", done->bad);
  if (done->pixels_far > 0) {
    say("sgs: {} measurements beyond {:.1f} m do not fit into 16 bits and were left out\n",
        done->pixels_far, done->farthest_m);
  }
  print("{}\n", command.folder);
  if (!done->stopped) return kExitDone;
  say("sgs: stopped; the {} frames so far are a complete sequence\n", done->frames);
  return kExitInterrupted;
}

}  // namespace

void add_convert(CLI::App& app, Action& action) {
  auto command = std::make_shared<ConvertCommand>();
  auto* sub = app.add_subcommand(
      "convert", "Write any input as a folder in TUM layout: images, times, calibration, truth");
  add_input_and_output(*sub, command->input, command->folder, "OUT",
                       "What `sgs run` takes, and the folder to create");
  sub->add_option("--frames", command->input.frames, "a:b, frames a to b-1 of the sequence");
  add_recording_options(*sub, command->input);
  sub->add_option("--threads", command->threads, "Threads that decode or render")
      ->check(CLI::Range(1, 256));
  sub->add_flag("--jpeg", command->jpeg, "Colour as JPEG (smaller) instead of PNG (lossless)");
  sub->add_flag("--quiet", command->quiet, "No progress, no warnings on the terminal");
  sub->callback([command, &action] { action = [command] { return run_convert(*command); }; });
}

}  // namespace sgs::app
