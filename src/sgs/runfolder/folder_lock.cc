// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/folder_lock.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <thread>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace fs = std::filesystem;
namespace {

std::string this_process() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  return fmt::format("process {}{}{}, started {:%F %T}", ::getpid(), host[0] != '\0' ? " on " : "",
                     host.data(), fmt::localtime(std::time(nullptr)));
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::shared_ptr<const int> owned(int fd) {
  return {new int(fd), [](const int* held) {
            ::close(*held);
            delete held;
          }};
}

/// False where somebody else has it. Those who only look hold it for a moment. File systems that
/// know no locks are no reason not to run.
bool try_lock(int fd, int how) {
  constexpr int kAttempts = 5;
  constexpr std::chrono::milliseconds kPause{20};
  for (int i = 0; i < kAttempts; ++i) {
    if (::flock(fd, how | LOCK_NB) == 0 || errno != EWOULDBLOCK) return true;
    if (how == LOCK_SH) return false;
    std::this_thread::sleep_for(kPause);
  }
  return false;
}

}  // namespace

FolderLock::FolderLock(fs::path folder) : folder_(std::move(folder)), owner_(this_process()) {}

Result<std::shared_ptr<FolderLock>> FolderLock::take(const fs::path& folder) {
  const std::shared_ptr<FolderLock> lock(new FolderLock(folder));
  SGS_RETURN_IF_ERROR(lock->acquire());
  return lock;
}

bool FolderLock::is_held(const fs::path& folder) {
  const int fd = ::open((folder / files::kLock).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return false;
  const auto file = owned(fd);
  return !try_lock(fd, LOCK_SH);
}

Status FolderLock::acquire() {
  SGS_RETURN_IF_ERROR(io::make_folder(folder_));
  const fs::path path = folder_ / files::kLock;
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) {
    return fail(ErrorCode::kIo,
                fmt::format("cannot write {}: {}", path.string(), std::strerror(errno)),
                "choose another folder");
  }
  const auto file = owned(fd);
  if (!try_lock(fd, LOCK_EX)) {
    const auto other = io::read_file(path).value_or("another process");
    return fail(ErrorCode::kIo,
                fmt::format("{} is being written by {}", folder_.string(), first_line(other)),
                "wait for it, or choose another folder");
  }
  const std::string text = owner_ + "\n";
  if (::ftruncate(fd, 0) != 0 || ::pwrite(fd, text.data(), text.size(), 0) < 0) {
    log().debug("{} could not be written: {}", path.string(), std::strerror(errno));
  }
  file_ = file;
  return {};
}

Status FolderLock::ensure() {
  const std::scoped_lock lock(mutex_);
  struct stat held {
  }, there{};
  if (::fstat(*file_, &held) != 0) return {};
  const fs::path path = folder_ / files::kLock;
  if (::stat(path.c_str(), &there) == 0) {
    if (held.st_dev == there.st_dev && held.st_ino == there.st_ino) return {};
  } else if (errno != ENOENT) {
    return {};  // no permission to look: writing will say more
  }
  SGS_RETURN_IF_ERROR(acquire());
  ++made_again_;
  log().warn("{} was removed during the run: it is made again", folder_.string());
  return {};
}

int FolderLock::times_made_again() const {
  const std::scoped_lock lock(mutex_);
  return made_again_;
}

}  // namespace sgs::run
