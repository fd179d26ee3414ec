// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/camera_program.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "sgs/io/json_file.h"
#include "sgs/stream/child_process.h"

namespace sgs::stream {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::string_view kPrefix = "sgs-camera-";
constexpr const char* kToInstall =
    "install the package sgs-cameras, or send frames yourself (docs/stream.md)";

/// What others publish, by a package of its own.
bool of_network(const std::string& family) { return family == "ros1" || family == "ros2"; }

std::vector<fs::path> program_folders() {
  std::vector<fs::path> folders;
  if (const char* given = std::getenv("SGS_CAMERA_PROGRAMS")) folders.emplace_back(given);
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (!error) folders.insert(folders.end(), {here, here / "../libexec/sgs"});
  return folders;
}

/// All that comes until the end, or as much as is believed, or until it is late.
std::string read_all(int descriptor, Clock::time_point until) {
  constexpr std::size_t kMost = std::size_t{1} << 20;
  std::string text;
  std::array<char, 4096> part{};
  while (text.size() < kMost) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd waiting{descriptor, POLLIN, 0};
    if (left <= 0 || ::poll(&waiting, 1, static_cast<int>(left)) == 0) break;
    const ssize_t bytes = ::read(descriptor, part.data(), part.size());
    if (bytes > 0) text.append(part.data(), static_cast<std::size_t>(bytes));
    if (bytes == 0 || (bytes < 0 && errno != EINTR && errno != EAGAIN)) break;
  }
  return text;
}

Status read_answer(const std::string& text, CameraFamily& family) {
  SGS_ASSIGN_OR_RETURN(const auto json, io::parse_json(text, "its answer"));
  return io::read_json("its answer", "library, devices", [&]() -> Status {
    family.library = json.value("library", "");
    for (const auto& entry : json.value("devices", nlohmann::json::array())) {
      family.devices.push_back({entry.value("name", ""), entry.value("serial", ""),
                                entry.value("firmware", ""), entry.value("connection", "")});
    }
    if (json.contains("problem")) {
      family.problem = Error{ErrorCode::kNotFound, json.at("problem").value("message", ""),
                             json.at("problem").value("remedy", "")};
    }
    return {};
  });
}

std::string lines_of(const std::vector<std::string>& lines) {
  return fmt::format("{}", fmt::join(lines, "; "));
}

Result<ChosenCamera> only_one(const std::vector<CameraProgram>& programs) {
  std::vector<std::string> problems, cameras;
  std::optional<ChosenCamera> chosen;
  for (const CameraProgram& program : programs) {
    // Whoever publishes in the network has not plugged in a camera here: `camera:ros2` says so.
    if (of_network(program.family)) continue;
    const CameraFamily family = ask_camera_program(program);
    if (family.problem) {
      problems.push_back(fmt::format("{}: {}", program.family, family.problem->text()));
    }
    for (const CameraDevice& device : family.devices) {
      chosen = ChosenCamera{program, device.serial};
      cameras.push_back(fmt::format("camera:{}:{}", program.family, device.serial));
    }
  }
  if (cameras.size() > 1) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} cameras are plugged in", cameras.size()),
                "choose one: " + lines_of(cameras));
  }
  if (chosen) return *chosen;
  return fail(ErrorCode::kNotFound, "no camera was found: " + lines_of(problems),
              "`sgs info --cameras` lists what is there");
}

}  // namespace

std::vector<CameraProgram> find_camera_programs() {
  std::map<std::string, fs::path> found;
  for (const fs::path& folder : program_folders()) {
    std::error_code error;
    for (auto entry = fs::directory_iterator(folder, error);
         !error && entry != fs::directory_iterator(); entry.increment(error)) {
      const std::string name = entry->path().filename().string();
      const bool ours = name.starts_with(kPrefix) && name.find('.') == std::string::npos;
      if (!ours || ::access(entry->path().c_str(), X_OK) != 0) continue;
      found.emplace(name.substr(kPrefix.size()), entry->path());
    }
  }
  std::vector<CameraProgram> programs;
  for (const auto& [family, path] : found) programs.push_back({family, path});
  return programs;
}

CameraFamily ask_camera_program(const CameraProgram& program) {
  constexpr std::chrono::seconds kPatience(10);
  CameraFamily family;
  family.program = program;
  auto child = ChildProcess::start(program.path, {"--list"});
  if (!child) {
    family.problem = child.error();
    return family;
  }
  const std::string text = read_all(child->output.get(), Clock::now() + kPatience);
  if (const Status read = read_answer(text, family); !read) {
    family.problem = Error{ErrorCode::kInvalidFormat,
                           fmt::format("{} does not say what is plugged in", program.path.string()),
                           "run it with --list to see why"};
  }
  return family;
}

Result<ChosenCamera> choose_camera(const Address::Camera& camera) {
  const auto programs = find_camera_programs();
  if (programs.empty()) {
    return fail(ErrorCode::kUnsupported, "no program for cameras is installed", kToInstall);
  }
  if (camera.family.empty()) return only_one(programs);
  const auto found = std::ranges::find(programs, camera.family, &CameraProgram::family);
  if (found != programs.end()) return ChosenCamera{*found, camera.serial};
  std::vector<std::string> names;
  for (const CameraProgram& program : programs) names.push_back("camera:" + program.family);
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("no program for cameras of the family '{}' is installed", camera.family),
              fmt::format("there is {}; {}", lines_of(names),
                          of_network(camera.family) ? "install the package sgs-" + camera.family
                                                    : kToInstall));
}

}  // namespace sgs::stream
