// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "ob_library.h"

#include <fmt/format.h>

#include "common/shared_library.h"

namespace sgs::cameras::ob {
namespace {

constexpr int kOldest = 20018, kMajor = 10000;

const LibrarySearch& search() {
  static const LibrarySearch where = {
      "libOrbbecSDK", "libOrbbecSDK.so.2*", "SGS_ORBBEC_LIBRARY",
      "install the Orbbec SDK 2.0.18 or later of version 2 (github.com/orbbec/OrbbecSDK_v2, "
      "releases), or name its file in SGS_ORBBEC_LIBRARY"};
  return where;
}

Result<std::shared_ptr<const Library>> library_of(void* handle, const std::string& asked) {
  auto library = std::make_shared<Library>();
  Symbols symbols(handle, asked);
#define SGS_OB_FIND(result, name, parameters) symbols.find(library->name, #name);
  SGS_OB_FUNCTIONS(SGS_OB_FIND)
#undef SGS_OB_FIND
  library->path = symbols.path();
  const bool is_one = library->ob_get_version != nullptr;
  if (is_one) library->version = library->ob_get_version();
  const std::string version = library->version_text();
  if (is_one && (library->version / kMajor != kOldest / kMajor || library->version < kOldest)) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} has version {}; needed is 2.0.18 or a later one of version 2",
                            library->path, version),
                search().to_install);
  }
  SGS_RETURN_IF_ERROR(check_symbols(symbols, search(), is_one, "ob_get_version", version));
  return library;
}

}  // namespace

const CameraWords& words() {
  static const CameraWords said = {
      "orbbec",       "Orbbec camera", "size=1280x720,fps=30", "size=640x480,fps=15",
      {{"2bc5", ""}}, kPlugIntoUsb3};
  return said;
}

std::string Library::version_text() const {
  constexpr int kMinor = 100;
  return fmt::format("{}.{}.{}", version / kMajor, version / kMinor % kMinor, version % kMinor);
}

Error Library::taken(ob_error* error) const {
  const char* message = ob_error_get_message(error);
  Error taken = explained(message == nullptr ? "an error without words" : message, words());
  ob_delete_error(error);
  return taken;
}

Result<std::shared_ptr<const Library>> open_library() {
  return cameras::open_library(search(), library_of);
}

}  // namespace sgs::cameras::ob
