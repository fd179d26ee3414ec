// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "freenect_library.h"

#include <fmt/format.h>

#include "common/shared_library.h"

namespace sgs::cameras::freenect {
namespace {

const LibrarySearch& search() {
  static const LibrarySearch where = {
      "libfreenect", "libfreenect.so.0*", "SGS_FREENECT_LIBRARY",
      "install libfreenect 0.5 or later (Debian: libfreenect0.5), or name its file in "
      "SGS_FREENECT_LIBRARY"};
  return where;
}

Result<std::shared_ptr<const Library>> library_of(void* handle, const std::string& asked) {
  auto library = std::make_shared<Library>();
  Symbols symbols(handle, asked);
#define SGS_FREENECT_FIND(result, name, parameters) symbols.find(library->name, #name);
  SGS_FREENECT_FUNCTIONS(SGS_FREENECT_FIND)
#undef SGS_FREENECT_FIND
  const bool is_one = library->freenect_init != nullptr;
  SGS_RETURN_IF_ERROR(check_symbols(symbols, search(), is_one, "freenect_init", ""));
  library->path = real_path(symbols.path());
  return library;
}

}  // namespace

const CameraWords& words() {
  static const CameraWords said = {
      "freenect",
      "Kinect",
      "size=640x480,fps=30",
      "size=640x480,fps=30",
      {{"045e", "Xbox NUI"}, {"045e", "Kinect"}},
      "plug it in with the cable that has a power supply of its own; libfreenect reads the first "
      "Kinect (Xbox 360, or for Windows version 1) and no other"};
  return said;
}

LibraryLog& log() {
  static LibraryLog kept;
  return kept;
}

Error last_failure(const std::string& what) {
  const std::string lines = log().take();
  return explained(lines.empty() ? what : fmt::format("{}: {}", what, lines), words());
}

Result<std::shared_ptr<const Library>> open_library() {
  return cameras::open_library(search(), library_of);
}

}  // namespace sgs::cameras::freenect
