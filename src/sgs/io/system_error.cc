// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/system_error.h"

#include <cerrno>
#include <cstring>

namespace sgs::io {
namespace {

std::string remedy_for(int code) {
  switch (code) {
    case ENOSPC:
    case EDQUOT:
      return "free some space or choose another folder";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a place with the needed permissions";
    case ENOENT:
      return "check the path";
    case ENAMETOOLONG:
      return "choose a shorter name";
    case EISDIR:
      return "a file is needed here, not a folder";
    default:
      return "";
  }
}

}  // namespace

tl::unexpected<Error> system_error(const char* action, const std::filesystem::path& path,
                                   int code) {
  const bool missing = code == ENOENT || code == ENOTDIR;
  return fail(missing ? ErrorCode::kNotFound : ErrorCode::kIo,
              fmt::format("cannot {} {}: {}", action, path.string(), std::strerror(code)),
              remedy_for(code));
}

}  // namespace sgs::io
