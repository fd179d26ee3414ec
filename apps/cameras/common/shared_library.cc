// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "shared_library.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace sgs::cameras {
namespace {

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

std::vector<std::string> folders_of_libraries() {
  std::vector<std::string> folders = {"/usr/local/lib",
                                      "/usr/local/lib/*-linux-gnu",
                                      "/usr/lib",
                                      "/usr/lib/*-linux-gnu",
                                      "/opt/*/lib",
                                      "/opt/ros/*/lib",
                                      "/opt/ros/*/lib/*-linux-gnu"};
  if (const char* given = std::getenv("LD_LIBRARY_PATH")) {
    std::string_view rest = given;
    while (!rest.empty()) {
      const auto end = std::min(rest.find(':'), rest.size());
      if (end > 0) folders.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  return folders;
}

}  // namespace

void* open_library_file(const std::string& path) {
  return ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
}

Result<std::optional<std::string>> library_given(const LibrarySearch& search) {
  const char* given = std::getenv(search.variable.c_str());
  if (given == nullptr || *given == '\0') return std::optional<std::string>();
  if (open_library_file(given) != nullptr) return std::optional<std::string>(given);
  return fail(ErrorCode::kNotFound,
              fmt::format("{} = {} cannot be opened: {}", search.variable, given, ::dlerror()),
              fmt::format("name the file {}.so, or unset it", search.name));
}

std::vector<std::string> library_candidates(const LibrarySearch& search) {
  std::vector<std::string> files;
  for (const std::string& folder : folders_of_libraries()) {
    const auto here = matching(folder + "/" + search.versions);
    files.insert(files.end(), here.begin(), here.end());
  }
  std::ranges::stable_sort(files, std::ranges::greater(), numbers_of);
  files.insert(files.begin(), search.name + ".so");
  return files;
}

void* Symbols::look_up(const char* name) {
  void* symbol = ::dlsym(handle_, name);
  if (symbol == nullptr) {
    if (missing_.empty()) missing_ = name;
    return nullptr;
  }
  Dl_info info{};
  if (!found_ && ::dladdr(symbol, &info) != 0 && info.dli_fname != nullptr) path_ = info.dli_fname;
  found_ = true;
  return symbol;
}

std::string real_path(const std::string& path) {
  std::error_code error;
  const auto real = std::filesystem::canonical(path, error);
  return error ? path : real.string();
}

Status check_symbols(const Symbols& symbols, const LibrarySearch& search, bool has_first,
                     const std::string& first, const std::string& version_text) {
  if (!has_first) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} is no {}: it has no {}", symbols.path(), search.name, first),
                search.to_install);
  }
  if (symbols.missing().empty()) return {};
  const std::string version =
      version_text.empty() ? "" : fmt::format(" (version {})", version_text);
  return fail(ErrorCode::kUnsupported,
              fmt::format("{}{} lacks the function {}", symbols.path(), version, symbols.missing()),
              search.to_install);
}

}  // namespace sgs::cameras
