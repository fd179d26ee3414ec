// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/byte_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "sgs/io/foreign_content.h"

namespace sgs::bag {
namespace {

/// Headers lie close together; bodies are mostly jumped over.
constexpr std::uint64_t kReadAhead_bytes = 16 << 10;

std::string system_reason() { return std::generic_category().message(errno); }

}  // namespace

Result<ByteFile> ByteFile::open(const std::filesystem::path& path) {
  // Without O_NONBLOCK a pipe that nobody writes to would never open.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    return fail(errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
                fmt::format("{}: {}", path.string(), system_reason()),
                errno == EACCES ? "you may not read it: `chmod u+r` gives you the right" : "");
  }
  struct stat status {};
  ByteFile file(path, descriptor, 0);
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: not a file", path.string()),
                "give the file of the recording, no pipe or device");
  }
  file.size_ = static_cast<std::uint64_t>(status.st_size);
  return file;
}

ByteFile::ByteFile(std::filesystem::path path, int descriptor, std::uint64_t size)
    : path_(std::move(path)), descriptor_(descriptor), size_(size) {}

ByteFile::~ByteFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

ByteFile::ByteFile(ByteFile&& other) noexcept { *this = std::move(other); }

ByteFile& ByteFile::operator=(ByteFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  std::swap(buffer_at_, other.buffer_at_);
  std::swap(buffer_, other.buffer_);
  return *this;
}

Result<std::string_view> ByteFile::view(std::uint64_t offset, std::uint64_t bytes) {
  if (!holds(offset, bytes)) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} bytes at byte {} go beyond the end ({} bytes)", path_.string(),
                            bytes, offset, size_),
                "the file is damaged or was cut off; copy or record it again");
  }
  if (bytes > kLargestPiece_bytes) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: a record of {} bytes at byte {} is larger than {}", path_.string(),
                            bytes, offset, kLargestPiece_bytes),
                "the file is damaged; copy or record it again");
  }
  const bool there = offset >= buffer_at_ && offset + bytes <= buffer_at_ + buffer_.size();
  if (!there) {
    const std::uint64_t wanted = std::min(std::max(bytes, kReadAhead_bytes), size_ - offset);
    buffer_.resize(wanted);
    buffer_at_ = offset;
    std::uint64_t done = 0;
    while (done < wanted) {
      const ssize_t n = ::pread(descriptor_, buffer_.data() + done, wanted - done,
                                static_cast<off_t>(offset + done));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        buffer_.clear();
        return fail(ErrorCode::kIo, fmt::format("{}: cannot be read at byte {}: {}", path_.string(),
                                                offset, n < 0 ? system_reason() : "it shrank"));
      }
      done += static_cast<std::uint64_t>(n);
    }
  }
  return std::string_view(buffer_).substr(offset - buffer_at_, bytes);
}

tl::unexpected<Error> not_of_its_name(ByteFile& file, const std::string& expected) {
  constexpr std::uint64_t kBeginning_bytes = 64;
  const auto begin = file.view(0, std::min(file.size(), kBeginning_bytes));
  const auto foreign = begin ? io::foreign_content(*begin, file.path()) : std::nullopt;
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{}: not {}{}", file.path().string(), expected,
                          foreign ? ", but " + foreign->what : ""),
              foreign ? foreign->remedy
                      : "copy or download it again: a file of this kind begins otherwise");
}

}  // namespace sgs::bag
