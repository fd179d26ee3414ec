// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace sgs::io {
namespace fs = std::filesystem;
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
    case EISDIR:
      return "a file is needed here, not a folder";
    default:
      return "";
  }
}

tl::unexpected<Error> system_error(const char* action, const fs::path& path, int code) {
  const bool missing = code == ENOENT || code == ENOTDIR;
  return fail(missing ? ErrorCode::kNotFound : ErrorCode::kIo,
              fmt::format("cannot {} {}: {}", action, path.string(), std::strerror(code)),
              remedy_for(code));
}

/// Owns a file descriptor; close() reports errors, the destructor does not.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

/// Opens, writes everything, closes; returns errno of the first failure, else 0.
int write_all(const fs::path& path, int flags, std::string_view bytes) {
  Descriptor file(::open(path.c_str(), flags | O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
  if (file.get() < 0) return errno;
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return file.close() ? 0 : errno;
}

Status make_parent(const fs::path& path) {
  const fs::path parent = path.parent_path();
  return parent.empty() ? Status{} : make_folder(parent);
}

}  // namespace

Result<std::string> read_file(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return system_error("read", path, errno);
  std::string content;
  struct stat info {};
  if (::fstat(file.get(), &info) == 0 && S_ISREG(info.st_mode)) {
    content.reserve(static_cast<std::size_t>(info.st_size) + 1);
  }
  constexpr std::size_t kBlock = 1 << 16;
  while (true) {
    const std::size_t size = content.size();
    content.resize(std::max(size + kBlock, content.capacity()));
    const ssize_t got = ::read(file.get(), content.data() + size, content.size() - size);
    const int code = errno;
    content.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0 && code == EINTR) continue;
    if (got < 0) return system_error("read", path, code);
    if (got == 0) return content;
  }
}

Status make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error && !fs::is_directory(path)) {
    return fail(ErrorCode::kIo,
                fmt::format("cannot create folder {}: {}", path.string(), error.message()),
                remedy_for(error.value()));
  }
  return {};
}

Status write_file(const fs::path& path, std::string_view bytes) {
  SGS_RETURN_IF_ERROR(make_parent(path));
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode)) {
    // A device or a pipe cannot be replaced by a rename (a folder fails here, as it should).
    const int code = write_all(path, 0, bytes);
    return code == 0 ? Status{} : system_error("write", path, code);
  }
  fs::path temporary = path;
  temporary += fmt::format(".{}.tmp", ::getpid());
  int code = write_all(temporary, O_TRUNC, bytes);
  if (code == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) code = errno;
  if (code == 0) return {};
  ::unlink(temporary.c_str());
  return system_error("write", path, code);
}

Status append_file(const fs::path& path, std::string_view bytes) {
  SGS_RETURN_IF_ERROR(make_parent(path));
  const int code = write_all(path, O_APPEND, bytes);
  return code == 0 ? Status{} : system_error("write", path, code);
}

}  // namespace sgs::io
