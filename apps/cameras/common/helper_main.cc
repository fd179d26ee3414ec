// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "helper_main.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include "sgs/capture/serve_camera.h"

namespace sgs::cameras {
namespace {

enum ExitCode : int { kDone = 0, kFailed = 1, kUsage = 2 };

capture::ServeRequests requests;

extern "C" void on_signal(int) { requests.stop = true; }

void say(std::string_view kind, std::string_view text) {
  std::fprintf(stderr, "%.*s: %.*s\n", static_cast<int>(kind.size()), kind.data(),
               static_cast<int>(text.size()), text.data());
}

int end_with(const Error& error) {
  say("error", error.message);
  if (!error.remedy.empty()) say("remedy", error.remedy);
  return error.code == ErrorCode::kInvalidArgument ? kUsage : kFailed;
}

/// A library that hangs while it is asked to stop must not keep the camera.
void end_soon() {
  std::this_thread::sleep_for(std::chrono::seconds(2));
  std::_Exit(kFailed);
}

/// Lines from the other end, until there is none.
void listen() {
  for (std::string line; std::getline(std::cin, line);) {
    if (line == "lock_exposure") requests.lock_exposure = true;
    if (line == "stop") break;
  }
  requests.stop = true;
  end_soon();
}

/// Standard output for frames alone; libraries that print there do so to standard error.
int take_standard_output() {
  const int frames = ::dup(STDOUT_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  return frames;
}

void print_list(const stream::CameraFamily& family, int descriptor) {
  nlohmann::json json = {{"library", family.library}, {"devices", nlohmann::json::array()}};
  for (const auto& device : family.devices) {
    json["devices"].push_back({{"name", device.name},
                               {"serial", device.serial},
                               {"firmware", device.firmware},
                               {"connection", device.connection}});
  }
  if (family.problem) {
    json["problem"] = {{"message", family.problem->message}, {"remedy", family.problem->remedy}};
  }
  const std::string text = json.dump(2, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
  [[maybe_unused]] const auto written = ::write(descriptor, text.data(), text.size());
}

/// "640x480".
void take_size(const std::string& text, capture::CameraMode& mode) {
  int end = 0;
  const int read = std::sscanf(text.c_str(), "%5dx%5d%n", &mode.width, &mode.height, &end);
  if (read != 2 || static_cast<std::size_t>(end) != text.size() || mode.width <= 0 ||
      mode.height <= 0) {
    throw CLI::ValidationError("size", "'" + text + "' is no size, such as 640x480");
  }
}

struct HelperOptions {
  capture::ServeOptions serve;
  std::string size, imu = "on", every = "off";
  bool list = false;
};

void add_options(CLI::App& app, HelperOptions& options) {
  const auto on_or_off = CLI::IsMember({"on", "off"});
  app.add_flag("--list", options.list, "Print which cameras are plugged in, as JSON");
  app.add_option("--serial", options.serve.mode.serial, "Of the camera; default: the first one");
  app.add_option("--size", options.size, "Of the images, default 640x480");
  app.add_option("--fps", options.serve.mode.fps, "Images a second")->check(CLI::Range(1, 300));
  app.add_option("--skip", options.serve.skip, "First frames left out: exposure settles")
      ->check(CLI::Range(0, 10000));
  app.add_option("--frames", options.serve.frames, "End after so many; 0 = never")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 40));
  app.add_option("--imu", options.imu, "Send inertial samples, if there are any")->check(on_or_off);
  app.add_option("--every", options.every, "Slow the camera down rather than drop frames")
      ->check(on_or_off);
  app.add_flag("--listen", options.serve.listens,
               "Take lines from standard input: lock_exposure, stop; its end is a stop");
}

}  // namespace

int helper_main(int argc, char** argv, const std::string& what,
                std::unique_ptr<capture::CameraDriver> driver, const OwnOptions& own) try {
  std::signal(SIGPIPE, SIG_IGN);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, on_signal);
  CLI::App app{what};
  HelperOptions options;
  add_options(app, options);
  if (own) own(app);
  capture::CameraMode& mode = options.serve.mode;
  try {
    app.parse(argc, argv);
    if (!options.size.empty()) take_size(options.size, mode);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return end_with({ErrorCode::kInvalidArgument, error.what(), "--help lists the options"});
  }
  mode.given = !options.size.empty() || app.count("--fps") > 0;
  mode.imu = options.imu == "on";
  mode.every_frame = options.every == "on";
  const int frames = take_standard_output();
  if (options.list) {
    print_list(driver->list(), frames);
    return kDone;
  }
  if (options.serve.listens) std::thread(listen).detach();
  const Status served = capture::serve_camera(*driver, options.serve, frames, requests,
                                              [](const std::string& text) { say("note", text); });
  const int code = served ? kDone : end_with(served.error());
  std::fflush(stderr);
  // Threads of the library, or the one that listens, may still be there.
  std::_Exit(code);
} catch (...) {
  return end_with(current_error());
}

}  // namespace sgs::cameras
