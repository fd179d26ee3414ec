// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/calibrate.h"

#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "input_options.h"
#include "interrupt.h"
#include "log_setup.h"
#include "progress.h"
#include "sgs/core/print.h"
#include "sgs/io/depth_calibration_io.h"

namespace sgs::app {
namespace {

struct CalibrateCommand {
  run::InputSpec input;
  run::ConfigSources config;
  std::string output = "calibration.toml";
  int threads = 2;
  bool quiet = false;
};

void print_estimate(const backend::DepthEstimate& e) {
  const DepthCalibration& c = e.calibration;
  const auto used = [](bool known, bool contradicted) {
    if (contradicted) return "parts of the recording contradict each other, not used";
    return known ? "used" : "not told apart from none, not used";
  };
  print("keyframes      {}\nmean offset    {:+.5f} /m, sigma {:.5f}: {}\n", e.keyframes,
        c.mean_offset_per_m(), c.mean_sigma_per_m, used(e.known.mean, e.contradicted.mean));
  print("shape          {:.5f} /m rms, sigma {:.5f}: {}\n", e.shape_rms_per_m, e.shape_sigma_per_m,
        used(e.known.shape, e.contradicted.shape));
  print("shift          {:+.2f} {:+.2f} px of depth against colour, sigma {:.2f} {:.2f}: {}\n",
        c.shift_px.x(), c.shift_px.y(), c.shift_sigma_px.x(), c.shift_sigma_px.y(),
        used(e.known.shift, e.contradicted.shift));
  print("delay          {:+.1f} ms of depth after colour, sigma {:.1f}: {}\n", 1e3 * c.delay_s,
        1e3 * c.delay_sigma_s, used(e.known.delay, e.contradicted.delay));
}

int run_calibrate(CalibrateCommand command) {
  const auto config = run::resolve_config(command.config, command.input);
  if (!config) return report(config.error());
  auto input = run::open_input(command.input, command.threads);
  if (!input) return report(input.error());
  setup_logging({}, command.quiet);
  Progress progress("frames", input->source->size(), command.quiet);
  const auto estimate = run::calibrate(
      *input, config->session, [&](const auto&, const auto*) { progress.step(""); }, stop_token());
  progress.finish();
  if (!estimate) return report(estimate.error());
  if (!estimate->why_not.empty()) {
    return report({ErrorCode::kUnsupported,
                   fmt::format("{}: {}", input->info.name, estimate->why_not),
                   "record ten seconds of textured surfaces at different distances; the depth "
                   "camera is used as it is"});
  }
  print_estimate(*estimate);
  for (const std::string& warning : estimate->warnings()) say("sgs: {}\n", warning);
  if (!estimate->refused.empty()) {
    say("sgs: {}: {}: the depth camera is used as it is, {} is not written\n", input->info.name,
        estimate->refused, command.output);
    return kExitLost;
  }
  if (const auto saved = io::save_depth_calibration(command.output, estimate->calibration);
      !saved) {
    return report(saved.error());
  }
  print("{}\n", command.output);
  return kExitDone;
}

}  // namespace

void add_calibrate(CLI::App& app, Action& action) {
  auto command = std::make_shared<CalibrateCommand>();
  auto* sub = app.add_subcommand(
      "calibrate", "Find what is wrong with a recording's depth camera, without a target");
  add_input_argument(
      *sub, command->input,
      "Sequence folder, bag (or the files of one), an Azure Kinect's .mkv, or synth:NAME[:LEVEL]")
      ->required();
  sub->add_option("-o,--output", command->output, "File to write, for `sgs run --calibration`")
      ->capture_default_str();
  add_tracking_options(*sub, command->input, command->config);
  sub->add_option("--threads", command->threads, "Threads that decode or render")
      ->check(CLI::Range(1, 256));
  sub->add_flag("--quiet", command->quiet, "No progress, no warnings on the terminal");
  sub->callback([command, &action] { action = [command] { return run_calibrate(*command); }; });
}

}  // namespace sgs::app
