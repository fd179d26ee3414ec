// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "rs2_library.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <vector>

namespace sgs::cameras::rs2 {
namespace {

constexpr int kOldest = 23100, kMajor = 10000;
constexpr const char* kVariable = "SGS_REALSENSE_LIBRARY";
constexpr const char* kToInstall =
    "install librealsense2 2.31 or later (github.com/IntelRealSense/librealsense, "
    "doc/distribution_linux.md), or name its file in SGS_REALSENSE_LIBRARY";

/// The numbers at the end of librealsense2.so.2.50.4.
std::vector<int> numbers_of(const std::string& path) {
  constexpr std::string_view kStem = ".so.";
  std::vector<int> numbers;
  const auto stem = path.rfind(kStem);
  std::string_view rest = std::string_view(path).substr(stem + kStem.size());
  while (!rest.empty()) {
    int number = 0;
    const auto read = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    if (read.ec != std::errc{}) break;
    numbers.push_back(number);
    rest.remove_prefix(static_cast<std::size_t>(read.ptr - rest.data()));
    if (!rest.empty()) rest.remove_prefix(1);
  }
  return numbers;
}

std::vector<std::string> matching(const std::string& pattern) {
  std::vector<std::string> paths;
  glob_t found{};
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  ::globfree(&found);
  return paths;
}

/// Those with a version in their name, newest first.
std::vector<std::string> versioned_files() {
  std::vector<std::string> folders = {"/usr/local/lib", "/usr/local/lib/*-linux-gnu",
                                      "/usr/lib",       "/usr/lib/*-linux-gnu",
                                      "/opt/ros/*/lib", "/opt/ros/*/lib/*-linux-gnu"};
  if (const char* given = std::getenv("LD_LIBRARY_PATH")) {
    std::string_view rest = given;
    while (!rest.empty()) {
      const auto end = std::min(rest.find(':'), rest.size());
      if (end > 0) folders.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  std::vector<std::string> files;
  for (const std::string& folder : folders) {
    const auto here = matching(folder + "/librealsense2.so.2.*");
    files.insert(files.end(), here.begin(), here.end());
  }
  std::ranges::stable_sort(files, std::ranges::greater(), numbers_of);
  return files;
}

/// The file that a handle was loaded from.
std::string file_of(void* symbol, const std::string& asked) {
  Dl_info info{};
  return ::dladdr(symbol, &info) != 0 && info.dli_fname != nullptr ? info.dli_fname : asked;
}

Result<std::shared_ptr<const Library>> library_of(void* handle, const std::string& asked) {
  auto library = std::make_shared<Library>();
  library->path = asked;
  bool first = true;
  std::string missing;
  const auto find = [&](auto& function, const char* name) {
    void* symbol = ::dlsym(handle, name);
    if (std::exchange(first, false) && symbol != nullptr) library->path = file_of(symbol, asked);
    if (symbol == nullptr && missing.empty()) missing = name;
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(symbol);
  };
#define SGS_RS2_FIND(result, name, parameters) find(library->name, #name);
  SGS_RS2_FUNCTIONS(SGS_RS2_FIND)
#undef SGS_RS2_FIND
  if (library->rs2_get_api_version == nullptr) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} is no librealsense2: it has no rs2_get_api_version", asked),
                kToInstall);
  }
  if (library->rs2_free_error == nullptr || library->rs2_get_error_message == nullptr) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} lacks the function {}", library->path, missing), kToInstall);
  }
  SGS_ASSIGN_OR_RETURN(library->version, library->call(library->rs2_get_api_version));
  if (library->version / kMajor != kOldest / kMajor || library->version < kOldest) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} has version {}; needed is 2.31 or a later one of version 2",
                            library->path, library->version_text()),
                kToInstall);
  }
  if (!missing.empty()) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} (version {}) lacks the function {}", library->path,
                            library->version_text(), missing),
                kToInstall);
  }
  return library;
}

bool has_any(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(
      words, [&](std::string_view word) { return text.find(word) != std::string_view::npos; });
}

}  // namespace

std::string Library::version_text() const {
  constexpr int kMinor = 100;
  return fmt::format("{}.{}.{}", version / kMajor, version / kMinor % kMinor, version % kMinor);
}

Error Library::taken(rs2_error* error) const {
  const char* message = rs2_get_error_message(error);
  Error taken = explained(message == nullptr ? "an error without words" : message);
  rs2_free_error(error);
  return taken;
}

Error explained(const std::string& message) {
  const std::string said = fmt::format("the camera's library says: {}", message);
  if (has_any(message, {"busy", "Busy", "BUSY", "already opened", "in use"})) {
    return {ErrorCode::kIo, fmt::format("the camera is used by another program ({})", message),
            "end that program; `fuser /dev/video*` names it"};
  }
  if (has_any(message, {"ermission", "ACCESS", "EACCES", "not permitted"})) {
    return {ErrorCode::kIo, fmt::format("no permission to open the camera ({})", message),
            "install the udev rules 60-sgs-cameras.rules of the package sgs-cameras to "
            "/etc/udev/rules.d, `sudo udevadm control --reload && sudo udevadm trigger`, and plug "
            "the camera in again"};
  }
  if (has_any(message, {"resolve requests"})) {
    return {ErrorCode::kInvalidArgument, fmt::format("the camera has no such mode ({})", message),
            "ask for another: camera:realsense,size=848x480,fps=15; at USB 2 few modes are left"};
  }
  if (has_any(message, {"No device connected", "disconnected"})) {
    return {ErrorCode::kIo, fmt::format("the camera is not there any more ({})", message),
            "plug it in again"};
  }
  return {ErrorCode::kIo, said, "unplug the camera and plug it in again"};
}

Result<std::shared_ptr<const Library>> open_library() {
  constexpr int kFlags = RTLD_NOW | RTLD_LOCAL;
  if (const char* given = std::getenv(kVariable); given != nullptr && *given != '\0') {
    void* handle = ::dlopen(given, kFlags);
    if (handle != nullptr) return library_of(handle, given);
    return fail(ErrorCode::kNotFound,
                fmt::format("{} = {} cannot be opened: {}", kVariable, given, ::dlerror()),
                "name the file librealsense2.so, or unset it");
  }
  std::vector<std::string> candidates = {"librealsense2.so"};
  const auto files = versioned_files();
  candidates.insert(candidates.end(), files.begin(), files.end());
  std::optional<Error> problem;
  for (const std::string& candidate : candidates) {
    void* handle = ::dlopen(candidate.c_str(), kFlags);
    if (handle == nullptr) continue;
    auto library = library_of(handle, candidate);
    if (library) return library;
    if (!problem) problem = library.error();
  }
  if (problem) return tl::unexpected<Error>(*problem);
  return fail(ErrorCode::kNotFound, "librealsense2 is not installed", kToInstall);
}

}  // namespace sgs::cameras::rs2
