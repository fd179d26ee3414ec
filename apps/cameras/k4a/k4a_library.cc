// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "k4a_library.h"

#include <fmt/format.h>

#include "common/library_log.h"
#include "common/shared_library.h"

namespace sgs::cameras::k4a {
namespace {

const LibrarySearch& search() {
  static const LibrarySearch where = {
      "libk4a", "libk4a.so.1*", "SGS_K4A_LIBRARY",
      "install libk4a 1.2 or later (packages.microsoft.com, Ubuntu's libk4a1.4; for Femto cameras "
      "github.com/orbbec/OrbbecSDK-K4A-Wrapper), or name its file in SGS_K4A_LIBRARY"};
  return where;
}

LibraryLog& log() {
  static LibraryLog kept;
  return kept;
}

/// Called by threads of the library.
void keep_line(void*, int, const char*, int, const char* message) { log().add(message); }

Result<std::shared_ptr<const Library>> library_of(void* handle, const std::string& asked) {
  auto library = std::make_shared<Library>();
  Symbols symbols(handle, asked);
#define SGS_K4A_FIND(result, name, parameters) symbols.find(library->name, #name);
  SGS_K4A_FUNCTIONS(SGS_K4A_FIND)
#undef SGS_K4A_FIND
  const bool is_one = library->k4a_device_get_installed_count != nullptr;
  SGS_RETURN_IF_ERROR(
      check_symbols(symbols, search(), is_one, "k4a_device_get_installed_count", ""));
  library->path = real_path(symbols.path());
  library->k4a_set_debug_message_handler(keep_line, nullptr, kLogError);
  return library;
}

}  // namespace

const CameraWords& words() {
  static const CameraWords said = {"k4a",
                                   "Azure Kinect",
                                   "size=1280x720,fps=15",
                                   "size=1280x720,fps=15",
                                   {{"045e", "Azure Kinect"}, {"2bc5", "Femto"}},
                                   kPlugIntoUsb3};
  return said;
}

Error last_failure(const std::string& what) {
  const std::string lines = log().take();
  const auto says = [&](const char* word) { return lines.find(word) != std::string::npos; };
  if (says("epth engine") || says("epth Engine") || says("depthengine")) {
    return {ErrorCode::kIo, fmt::format("{}: {}", what, lines),
            "the depth engine (libdepthengine.so.2.0, in the package of libk4a) must be beside "
            "libk4a, and needs OpenGL: a desktop, or DISPLAY set to one"};
  }
  return explained(lines.empty() ? what : fmt::format("{}: {}", what, lines), words());
}

Result<std::shared_ptr<const Library>> open_library() {
  return cameras::open_library(search(), library_of);
}

}  // namespace sgs::cameras::k4a
