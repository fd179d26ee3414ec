// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/append_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "sgs/io/atomic_file.h"
#include "sgs/io/system_error.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

/// Writes as much of `bytes` as goes and takes that off their front; returns errno, else 0.
int write_some(int fd, std::string& bytes) {
  std::size_t done = 0;
  int code = 0;
  while (done < bytes.size() && code == 0) {
    const ssize_t written = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (written >= 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      code = errno;
    }
  }
  bytes.erase(0, done);
  return code;
}

/// Appends everything that can be read from `from`; returns errno, else 0.
int copy_all(int from, int to) {
  constexpr std::size_t kBlock = 1 << 16;
  std::array<char, kBlock> block{};
  off_t at = 0;
  while (true) {
    const ssize_t got = ::pread(from, block.data(), block.size(), at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    if (got == 0) return 0;
    at += got;
    std::string bytes(block.data(), static_cast<std::size_t>(got));
    if (const int code = write_some(to, bytes); code != 0) return code;
  }
}

}  // namespace

AppendFile::AppendFile(fs::path path) : AppendFile(std::move(path), 0) {}

AppendFile::AppendFile(fs::path path, std::size_t bytes) : path_(std::move(path)), kept_(bytes) {}

Status AppendFile::open() {
  if (!path_.parent_path().empty()) SGS_RETURN_IF_ERROR(make_folder(path_.parent_path()));
  // Readable, too: should the file be removed, its content is still there for who holds it open.
  const int fd = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (fd < 0) return system_error("write", path_, errno);
  struct stat info {};
  const bool regular = ::fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
  const auto kept = std::min(static_cast<off_t>(kept_), info.st_size);
  if (regular && ::ftruncate(fd, kept) != 0) {
    const int code = errno;
    ::close(fd);
    return system_error("write", path_, code);
  }
  file_ = std::shared_ptr<const int>(new int(fd), [](const int* held) {
    ::close(*held);
    delete held;
  });
  return {};
}

Status AppendFile::write_pending() {
  if (!file_) SGS_RETURN_IF_ERROR(open());
  synced_ = synced_ && pending_.empty();
  const int code = write_some(*file_, pending_);
  return code == 0 ? Status{} : system_error("write", path_, code);
}

Status AppendFile::append(std::string_view bytes) {
  pending_ += bytes;
  return write_pending();
}

Status AppendFile::sync() {
  SGS_RETURN_IF_ERROR(write_pending());
  synced_ = synced_ || ::fdatasync(*file_) == 0 || errno == EINVAL || errno == ENOSYS;
  return synced_ ? Status{} : system_error("write", path_, errno);
}

Status AppendFile::restore() {
  struct stat info {};
  if (!file_ || ::stat(path_.c_str(), &info) == 0 || errno != ENOENT) return {};
  AppendFile again(path_);
  SGS_RETURN_IF_ERROR(again.open());
  if (const int code = copy_all(*file_, *again.file_); code != 0) {
    ::unlink(path_.c_str());
    return system_error("write", path_, code);
  }
  file_ = std::move(again.file_);
  synced_ = false;
  return write_pending();
}

std::string_view whole_lines(std::string_view text) {
  text = text.substr(0, text.find('\0'));
  const auto end = text.rfind('\n');
  return end == std::string_view::npos ? std::string_view() : text.substr(0, end + 1);
}

}  // namespace sgs::io
