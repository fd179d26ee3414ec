// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "interrupt.h"
#include "log_setup.h"
#include "sgs/core/print.h"
#include "sgs/dataset/source_failure.h"
#include "sgs/stream/stream_check.h"

namespace sgs::app {
namespace {

using Clock = std::chrono::steady_clock;

struct CameraTestCommand {
  std::string camera;
  double seconds = 10;
  bool json = false;
};

/// Looks at the stream for some seconds, or to its end.
void watch(stream::StreamSource& source, double seconds, stream::StreamCheck& check) {
  source.watch(check);
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < until && !interrupted()) {
    RgbdFrame frame;
    Error error;
    const auto read = source.next(frame, error);
    if (read == dataset::FrameRead::kEnd) return;
    if (read == dataset::FrameRead::kOk) {
      check.add(frame);
    } else {
      check.add_event(error.text());
    }
  }
}

Result<stream::StreamCheck> check_camera(const CameraTestCommand& command) {
  SGS_ASSIGN_OR_RETURN(const auto address, stream::parse_address(command.camera));
  stream::Patience patience;
  patience.greeting_s = patience.first_s;
  SGS_ASSIGN_OR_RETURN(auto source, stream::open_stream(address, patience, {}, stop_token()));
  stream::StreamCheck check(source->hello());
  const std::stop_callback stop(stop_token(), [&] { source->stop(); });
  try {
    watch(*source, command.seconds, check);
  } catch (const dataset::SourceFailure& failure) {
    check.add_event(failure.error().text());
  }
  return check;
}

int run_camera_test(const CameraTestCommand& command) {
  setup_logging({}, false);
  const auto check = check_camera(command);
  if (!check) return report(check.error());
  nlohmann::json json;
  for (const auto& line : check->lines()) {
    if (!command.json) print("{:<20} {}\n", line.key, line.text);
    json.push_back({{"key", line.key}, {"text", line.text}});
    if (line.value) json.back()["value"] = *line.value;
  }
  if (command.json) print("{}\n", json.dump(2));
  return kExitDone;
}

}  // namespace

void add_camera_test(CLI::App& app, Action& action) {
  auto command = std::make_shared<CameraTestCommand>();
  auto* sub = app.add_subcommand(
      "camera-test", "What a camera is like: rates, gaps, clocks, unit, share and noise of depth");
  sub->add_option("CAMERA", command->camera,
                  "camera:, camera:FAMILY[:SERIAL][,OPTIONS] or live:... (docs/cameras.md)")
      ->required();
  sub->add_option("--seconds", command->seconds, "How long it is looked at")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  sub->add_flag("--json", command->json, "Print JSON");
  sub->callback([command, &action] { action = [command] { return run_camera_test(*command); }; });
}

}  // namespace sgs::app
