// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "openni2_library.h"

#include <fmt/format.h>

#include "common/shared_library.h"

namespace sgs::cameras::openni2 {
namespace {

const LibrarySearch& search() {
  static const LibrarySearch where = {
      "libOpenNI2", "libOpenNI2.so.*", "SGS_OPENNI2_LIBRARY",
      "install OpenNI2 2.2 (Debian: libopenni2-0), or name its file in SGS_OPENNI2_LIBRARY"};
  return where;
}

Result<std::shared_ptr<const Library>> library_of(void* handle, const std::string& asked) {
  constexpr int kMajor = 2;
  auto library = std::make_shared<Library>();
  Symbols symbols(handle, asked);
#define SGS_OPENNI2_FIND(result, name, parameters) symbols.find(library->name, #name);
  SGS_OPENNI2_FUNCTIONS(SGS_OPENNI2_FIND)
#undef SGS_OPENNI2_FIND
  library->path = symbols.path();
  const bool is_one = library->oniInitialize != nullptr;
  const auto check = [&] {
    return check_symbols(symbols, search(), is_one, "oniInitialize", library->version);
  };
  if (library->oniGetVersion == nullptr) SGS_RETURN_IF_ERROR(check());
  const Version version = library->oniGetVersion();
  library->version =
      fmt::format("{}.{}.{}.{}", version.major, version.minor, version.maintenance, version.build);
  if (version.major != kMajor) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} has version {}; needed is 2.2", library->path, library->version),
                search().to_install);
  }
  SGS_RETURN_IF_ERROR(check());
  if (library->oniInitialize(kApiVersion) != kOk) {
    return tl::unexpected<Error>(library->failure("OpenNI2 does not start"));
  }
  return library;
}

}  // namespace

const CameraWords& words() {
  static const CameraWords said = {
      "openni2",
      "OpenNI2 camera",
      "size=320x240,fps=30",
      "size=320x240,fps=30",
      {{"1d27", ""}, {"2bc5", ""}},
      "plug it in, with the cable that came with it; a camera that is not PrimeSense's needs its "
      "maker's driver, lib*.so.0, in the folder OpenNI2/Drivers beside libOpenNI2"};
  return said;
}

Error Library::failure(const std::string& what) const {
  const char* more = oniGetExtendedError();
  return explained(more == nullptr || *more == '\0' ? what : fmt::format("{}: {}", what, more),
                   words());
}

Result<std::shared_ptr<const Library>> open_library() {
  return cameras::open_library(search(), library_of);
}

}  // namespace sgs::cameras::openni2
