// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/av_library.h"

#include <dlfcn.h>

#include <string>

namespace sgs::bag {
namespace {

/// Its structures are those of the headers for this number only.
constexpr const char* kFile = "libavformat.so." AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR);
constexpr const char* kPackage = "libavformat" AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR);

Result<AvLibrary> opened() {
  const auto missing = [](const std::string& what) {
    return fail(ErrorCode::kNotFound, fmt::format("{}: {}", kFile, what),
                fmt::format("install it, `apt install {}`: .mkv files are read with it", kPackage));
  };
  void* handle = ::dlopen(kFile, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return missing("not installed");
  AvLibrary library;
  const char* lacking = nullptr;
  // Functions of libavcodec and libavutil are found behind it.
  const auto find = [&](auto& function, const char* name) {
    void* symbol = ::dlsym(handle, name);
    if (symbol == nullptr) lacking = name;
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(symbol);
  };
#define SGS_AV_FIND(name) find(library.name, #name);
  SGS_AV_FUNCTIONS(SGS_AV_FIND)
#undef SGS_AV_FIND
  if (lacking != nullptr) return missing(fmt::format("it lacks the function {}", lacking));
  // What it would print of damaged files, our errors say.
  library.av_log_set_level(AV_LOG_QUIET);
  return library;
}

}  // namespace

Result<const AvLibrary*> av_library() {
  static const Result<AvLibrary> library = opened();
  if (!library) return tl::unexpected(library.error());
  return &*library;
}

}  // namespace sgs::bag
