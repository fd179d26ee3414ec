// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "commands.h"
#include "input_options.h"
#include "interrupt.h"
#include "log_setup.h"
#include "progress.h"
#include "sgs/core/log.h"
#include "sgs/core/print.h"
#include "sgs/dataset/feed_item.h"
#include "sgs/input/input.h"
#include "sgs/stream/frame_codec.h"
#include "sgs/stream/sender.h"

namespace sgs::app {
namespace {

using Clock = std::chrono::steady_clock;

struct SendCommand {
  run::InputSpec input;
  std::string to, color = "rgb8", depth = "f32";
  double retry_s = 10;
  int threads = 2;
  bool realtime = false, quiet = false;
};

/// Waits until then, or until the user wants to stop.
void sleep_until(Clock::time_point then) {
  std::mutex mutex;
  std::condition_variable_any changed;
  std::unique_lock lock(mutex);
  changed.wait_until(lock, stop_token(), then, [] { return false; });
}

Result<stream::Hello> greeting(const SendCommand& command, const run::Input& input) {
  stream::Hello hello;
  hello.name = input.info.name;
  hello.color_camera.camera = input.source->camera();
  SGS_ASSIGN_OR_RETURN(hello.color,
                       from_string<stream::ColorCoding>("coding of colour", command.color));
  SGS_ASSIGN_OR_RETURN(hello.depth,
                       from_string<stream::StreamDepth>("coding of depth", command.depth));
  const double stored = input.info.calibration.depth_scale;
  if (stored > 0) hello.depth_scale = stored;
  return hello;
}

/// The other end may not be there yet.
Result<std::unique_ptr<stream::Sender>> connect(const SendCommand& command,
                                                const stream::Address& address,
                                                const stream::Hello& hello) {
  constexpr auto kPeriod = std::chrono::milliseconds(200);
  const auto give_up = Clock::now() + std::chrono::duration<double>(command.retry_s);
  while (true) {
    auto sender = stream::Sender::open(address, hello, stop_token());
    const bool absent = !sender && sender.error().code == ErrorCode::kNotFound;
    if (!absent || Clock::now() >= give_up) return sender;
    sleep_until(Clock::now() + kPeriod);
    if (interrupted()) return fail(ErrorCode::kInterrupted, "interrupted");
  }
}

/// Sends all frames, at the camera's rate if that is wanted; returns how many could not be read.
Result<std::int64_t> send_frames(const SendCommand& command, dataset::FrameSource& source,
                                 const stream::Hello& hello, stream::Sender& sender,
                                 Progress& progress) {
  std::int64_t bad = 0;
  std::optional<double> first_time_s;
  const auto start = Clock::now();
  while (!interrupted()) {
    const auto item = dataset::read_item(source);
    if (!item) break;
    if (!item->frame) {
      log().warn("{}", item->bad_reason);
      bad += item->event ? 0 : 1;
      continue;
    }
    if (!first_time_s) first_time_s = item->timestamp_s;
    if (command.realtime) {
      sleep_until(start + std::chrono::duration_cast<Clock::duration>(
                              std::chrono::duration<double>(item->timestamp_s - *first_time_s)));
    }
    SGS_ASSIGN_OR_RETURN(const auto packet, stream::encode_frame(*item->frame, hello));
    SGS_RETURN_IF_ERROR(sender.send(packet));
    progress.step("");
  }
  return bad;
}

Result<std::int64_t> send_all(const SendCommand& command) {
  SGS_ASSIGN_OR_RETURN(const auto address, stream::parse_address(command.to));
  SGS_ASSIGN_OR_RETURN(auto input, run::open_input(command.input, command.threads, stop_token()));
  SGS_ASSIGN_OR_RETURN(const auto hello, greeting(command, input));
  SGS_ASSIGN_OR_RETURN(const auto sender, connect(command, address, hello));
  Progress progress("frames", input.source->size(), command.quiet);
  SGS_ASSIGN_OR_RETURN(const auto bad,
                       send_frames(command, *input.source, hello, *sender, progress));
  SGS_RETURN_IF_ERROR(sender->finish());
  progress.finish();
  return bad;
}

int run_send(const SendCommand& command) {
  setup_logging({}, command.quiet);
  const auto bad = send_all(command);
  if (!bad) return report(bad.error());
  if (*bad > 0) say("sgs: {} frames could not be read and were left out\n", *bad);
  return interrupted() ? kExitInterrupted : kExitDone;
}

}  // namespace

void add_send(CLI::App& app, Action& action) {
  auto command = std::make_shared<SendCommand>();
  auto* sub = app.add_subcommand("send", "Send any input to `sgs run live:...`, frame by frame");
  add_input_and_output(
      *sub, command->input, command->to, "TO",
      "What `sgs run` takes, and where it goes: live:tcp://ADDRESS:PORT, live:PIPE "
      "or live:- (standard output)");
  sub->add_option("--frames", command->input.frames, "a:b, frames a to b-1 of the sequence");
  sub->add_option("--poses", command->input.poses,
                  "Send poses, too: recorded, a TUM file, or COLMAP's images.txt");
  add_recording_options(*sub, command->input);
  sub->add_option("--color", command->color, "rgb8 or jpeg")
      ->check(CLI::IsMember({"rgb8", "jpeg"}))
      ->capture_default_str();
  sub->add_option("--depth", command->depth, "f32 or u16")
      ->check(CLI::IsMember({"f32", "u16"}))
      ->capture_default_str();
  sub->add_option("--retry", command->retry_s, "Try so many seconds to find the other end")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  sub->add_option("--threads", command->threads, "Threads that decode or render")
      ->check(CLI::Range(1, 256));
  sub->add_flag("--realtime", command->realtime, "At the camera's rate instead of at once");
  sub->add_flag("--quiet", command->quiet, "No progress, no warnings on the terminal");
  sub->callback([command, &action] { action = [command] { return run_send(*command); }; });
}

}  // namespace sgs::app
