// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "sgs/io/temporary_folder.h"

namespace sgs::fuzz {

/// What must hold of every input. Ends the program, which libFuzzer takes as a finding.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

/// A file in memory, for parsers that read files.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : fd_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    require(fd_ >= 0, "a file in memory can be made");
    require(::write(fd_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
            "a file in memory can be written");
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

/// A place for what is saved: writers replace whole files, which a MemoryFile is not made for.
inline std::filesystem::path scratch_file(const char* name) {
  static const io::TemporaryFolder folder;
  return folder / name;
}

/// A file that is read next: written in place, since a whole new file costs more than its parser.
inline void write_plainly(const std::filesystem::path& path, std::string_view bytes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file && std::filesystem::create_directories(path.parent_path())) {
    file = std::fopen(path.c_str(), "wb");
  }
  require(file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() &&
              std::fclose(file) == 0,
          "a file can be written");
}

/// The first byte of an input chooses among parsers; the rest is theirs.
struct Choice {
  Choice(const std::uint8_t* data, std::size_t size)
      : number(size > 0 ? data[0] : 0),
        rest(size > 0 ? std::string_view(reinterpret_cast<const char*>(data) + 1, size - 1)
                      : std::string_view()) {}
  unsigned number;
  std::string_view rest;
};

}  // namespace sgs::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
