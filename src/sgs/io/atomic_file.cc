// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "sgs/io/system_error.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kTemporary = ".tmp";  // after the file's name and the process's number

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

/// Whether what was written through `fd` is on the disk. Some file systems know no such thing: they
/// have done what they do.
bool synced(int fd) { return ::fsync(fd) == 0 || errno == EINVAL || errno == ENOSYS; }

/// Writes everything; returns errno of the first failure, else 0.
int write_bytes(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

/// One piece and no more.
NextBlock one_block(std::string_view bytes) {
  return [bytes]() mutable { return std::exchange(bytes, {}); };
}

/// Opens, writes everything, closes; returns errno of the first failure, else 0.
int write_all(const fs::path& path, int flags, const NextBlock& next,
              Durability durability = Durability::kRelaxed) {
  Descriptor file(::open(path.c_str(), flags | O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
  if (file.get() < 0) return errno;
  for (auto block = next(); !block.empty(); block = next()) {
    if (const int code = write_bytes(file.get(), block); code != 0) return code;
  }
  if (durability == Durability::kSynced && !synced(file.get())) return errno;
  return file.close() ? 0 : errno;
}

/// Removes a file when it goes, unless that is called off: also where an exception leaves a write.
class Remover {
 public:
  explicit Remover(const fs::path& path) : path_(&path) {}
  ~Remover() {
    if (path_ != nullptr) ::unlink(path_->c_str());
  }
  Remover(const Remover&) = delete;
  Remover& operator=(const Remover&) = delete;
  void call_off() { path_ = nullptr; }

 private:
  const fs::path* path_;
};

/// Puts a renamed entry of a folder on the disk; returns errno, else 0.
int sync_folder(const fs::path& path) {
  const Descriptor folder(::open(path.empty() ? "." : path.c_str(), O_RDONLY | O_DIRECTORY));
  if (folder.get() < 0) return errno == EACCES ? 0 : errno;  // writable, but not readable
  return synced(folder.get()) ? 0 : errno;
}

tl::unexpected<Error> too_large(const fs::path& path, std::int64_t limit_bytes) {
  return fail(ErrorCode::kUnsupported,
              fmt::format("cannot read {}: larger than {} MB", path.string(), limit_bytes >> 20),
              "is this the right file?");
}

Status make_parent(const fs::path& path) {
  const fs::path parent = path.parent_path();
  return parent.empty() ? Status{} : make_folder(parent);
}

}  // namespace

Result<std::string> read_file(const fs::path& path, std::int64_t limit_bytes) {
  // Without O_NONBLOCK, opening a pipe waits for somebody who writes to it.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) return system_error("read", path, errno);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return system_error("read", path, errno);
  if (S_ISDIR(info.st_mode)) return system_error("read", path, EISDIR);
  if (!S_ISREG(info.st_mode)) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("cannot read {}: a pipe or a device", path.string()),
                "copy its content to a file and give that");
  }
  if (info.st_size > limit_bytes) return too_large(path, limit_bytes);
  std::string content;
  content.reserve(static_cast<std::size_t>(info.st_size) + 1);
  constexpr std::size_t kBlock = 1 << 16;
  while (true) {
    const std::size_t size = content.size();
    content.resize(size < content.capacity() ? content.capacity() : size + kBlock);
    const ssize_t got = ::read(file.get(), content.data() + size, content.size() - size);
    const int code = errno;
    content.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0 && code == EINTR) continue;
    if (got < 0) return system_error("read", path, code);
    if (got == 0) return content;
    // Files of /proc have no size, and others grow.
    if (static_cast<std::int64_t>(content.size()) > limit_bytes) {
      return too_large(path, limit_bytes);
    }
  }
}

Status make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  std::error_code ignored;  // a path that is too long cannot be asked about either
  if (error && !fs::is_directory(path, ignored)) {
    return fail(ErrorCode::kIo,
                fmt::format("cannot create folder {}: {}", path.string(), error.message()),
                system_error("create", path, error.value()).value().remedy);
  }
  return {};
}

Status write_file(const fs::path& path, std::string_view bytes, Durability durability) {
  return write_file_in_blocks(path, one_block(bytes), durability);
}

Status write_file_in_blocks(const fs::path& path, const NextBlock& next, Durability durability) {
  SGS_RETURN_IF_ERROR(make_parent(path));
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode)) {
    // A device or a pipe cannot be replaced by a rename (a folder fails here, as it should).
    const int code = write_all(path, 0, next);
    return code == 0 ? Status{} : system_error("write", path, code);
  }
  fs::path temporary = path;
  temporary += fmt::format(".{}{}", ::getpid(), kTemporary);
  Remover remover(temporary);
  int code = write_all(temporary, O_TRUNC, next, durability);
  if (code == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) code = errno;
  if (code == 0) remover.call_off();
  if (code == 0 && durability == Durability::kSynced) code = sync_folder(path.parent_path());
  return code == 0 ? Status{} : system_error("write", path, code);
}

bool is_temporary_of(std::string_view name, std::string_view file) {
  if (!name.starts_with(file) || !name.ends_with(kTemporary)) return false;
  name.remove_prefix(file.size());
  if (name.size() < kTemporary.size() + 2 || name.front() != '.') return false;
  const std::string_view process = name.substr(1, name.size() - 1 - kTemporary.size());
  return std::all_of(process.begin(), process.end(), [](char c) { return c >= '0' && c <= '9'; });
}

Status append_file(const fs::path& path, std::string_view bytes) {
  SGS_RETURN_IF_ERROR(make_parent(path));
  const int code = write_all(path, O_APPEND, one_block(bytes));
  return code == 0 ? Status{} : system_error("write", path, code);
}

}  // namespace sgs::io
