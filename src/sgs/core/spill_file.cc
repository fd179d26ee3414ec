// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/spill_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

namespace sgs {
namespace fs = std::filesystem;

SpillFile::SpillFile(int descriptor)
    : file_(new int(descriptor), [](const int* held) {
        ::close(*held);
        delete held;
      }) {}

fs::path SpillFile::default_folder() {
  const char* chosen = std::getenv("TMPDIR");
  if (chosen != nullptr && *chosen != '\0') return chosen;
  std::error_code unreadable;
  return fs::is_directory("/var/tmp", unreadable) ? fs::path("/var/tmp") : fs::path("/tmp");
}

Result<SpillFile> SpillFile::create(const fs::path& folder) {
  std::string name = (folder / "sgs-spill-XXXXXX").string();
  const int fd = ::mkostemp(name.data(), O_CLOEXEC);
  if (fd < 0) {
    return fail(ErrorCode::kIo,
                fmt::format("cannot write in {}: {}", folder.string(), std::strerror(errno)),
                "set TMPDIR to a folder with space");
  }
  ::unlink(name.c_str());
  return SpillFile(fd);
}

Result<std::int64_t> SpillFile::append(const void* bytes, std::size_t size) {
  const auto* next = static_cast<const char*>(bytes);
  const auto room = free_.find(size);
  const bool used_again = room != free_.end() && !room->second.empty();
  const std::int64_t begin = used_again ? room->second.back() : size_;
  std::int64_t at = begin;
  for (std::size_t left = size; left > 0;) {
    const ssize_t written = ::pwrite(*file_, next, left, at);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      return fail(ErrorCode::kIo, fmt::format("cannot spill to disk: {}", std::strerror(errno)),
                  "free some space, or set TMPDIR to a folder with more");
    }
    next += written;
    at += written;
    left -= static_cast<std::size_t>(written);
  }
  if (used_again) room->second.pop_back();
  size_ = std::max(size_, at);
  return begin;
}

void SpillFile::read(std::int64_t at, void* bytes, std::size_t size) const {
  auto* next = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t got = ::pread(*file_, next, size, at);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      throw std::system_error(got < 0 ? errno : EIO, std::generic_category(),
                              "cannot read back what was spilled to disk");
    }
    next += got;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
}

}  // namespace sgs
