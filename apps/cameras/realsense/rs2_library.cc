// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "rs2_library.h"

#include <fmt/format.h>

#include "common/shared_library.h"

namespace sgs::cameras::rs2 {
namespace {

constexpr int kOldest = 23100, kMajor = 10000;

const LibrarySearch& search() {
  static const LibrarySearch where = {
      "librealsense2", "librealsense2.so.2.*", "SGS_REALSENSE_LIBRARY",
      "install librealsense2 2.31 or later (github.com/IntelRealSense/librealsense, "
      "doc/distribution_linux.md), or name its file in SGS_REALSENSE_LIBRARY"};
  return where;
}

Result<std::shared_ptr<const Library>> library_of(void* handle, const std::string& asked) {
  auto library = std::make_shared<Library>();
  Symbols symbols(handle, asked);
#define SGS_RS2_FIND(result, name, parameters) symbols.find(library->name, #name);
  SGS_RS2_FUNCTIONS(SGS_RS2_FIND)
#undef SGS_RS2_FIND
  library->path = symbols.path();
  const bool is_one = library->rs2_get_api_version != nullptr;
  const bool can_say =
      library->rs2_free_error != nullptr && library->rs2_get_error_message != nullptr;
  const auto check = [&](const std::string& version) {
    return check_symbols(symbols, search(), is_one, "rs2_get_api_version", version);
  };
  if (!is_one || !can_say) SGS_RETURN_IF_ERROR(check(""));
  SGS_ASSIGN_OR_RETURN(library->version, library->call(library->rs2_get_api_version));
  if (library->version / kMajor != kOldest / kMajor || library->version < kOldest) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} has version {}; needed is 2.31 or a later one of version 2",
                            library->path, library->version_text()),
                search().to_install);
  }
  SGS_RETURN_IF_ERROR(check(library->version_text()));
  return library;
}

}  // namespace

const CameraWords& words() {
  static const CameraWords said = {
      "realsense",           "RealSense camera",      "size=848x480,fps=15",
      "size=480x270,fps=15", {{"8086", "RealSense"}}, kPlugIntoUsb3};
  return said;
}

std::string Library::version_text() const {
  constexpr int kMinor = 100;
  return fmt::format("{}.{}.{}", version / kMajor, version / kMinor % kMinor, version % kMinor);
}

Error Library::taken(rs2_error* error) const {
  const char* message = rs2_get_error_message(error);
  Error taken = explained(message == nullptr ? "an error without words" : message, words());
  rs2_free_error(error);
  return taken;
}

Result<std::shared_ptr<const Library>> open_library() {
  return cameras::open_library(search(), library_of);
}

}  // namespace sgs::cameras::rs2
