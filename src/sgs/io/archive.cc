// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/archive.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "sgs/io/text.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

/// Commands with the file for {0} and what comes out for {1}.
constexpr const char* kTar = "mkdir -p {1} && tar -xf {0} -C {1}";

struct Packing {
  std::string_view ending;
  const char* command;
};

/// Longer endings first.
constexpr Packing kPackings[] = {
    {".tar.zstd", "mkdir -p {1} && tar --zstd -xf {0} -C {1}"},
    {".tar.zst", "mkdir -p {1} && tar --zstd -xf {0} -C {1}"},
    {".tar.gz", kTar},
    {".tar.bz2", kTar},
    {".tar.xz", kTar},
    {".tgz", kTar},
    {".tbz2", kTar},
    {".tbz", kTar},
    {".txz", kTar},
    {".tar", kTar},
    {".zip", "unzip {0} -d {1}"},
    {".zip.001", "7z x {0} -o{1}"},
    {".7z.001", "7z x {0} -o{1}"},
    {".7z", "7z x {0} -o{1}"},
    {".rar", "unrar x {0} {1}/"},
    {".zstd", "zstd -d {0} -o {1}"},
    {".zst", "zstd -d {0} -o {1}"},
    {".lz4", "lz4 -d {0} {1}"},
    {".gz", "gzip -dc {0} > {1}"},
    {".bz2", "bzip2 -dc {0} > {1}"},
    {".xz", "xz -dc {0} > {1}"},
};

}  // namespace

std::string shell_quoted(const fs::path& path) {
  const std::string text = path.string();
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("/._-+=:,@%").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return text;
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      quoted += c;
    }
  }
  return quoted + "'";
}

std::optional<Unpacking> unpacking_of(const fs::path& file) {
  const std::string name = lower_case(file.filename().string());
  for (const Packing& packing : kPackings) {
    if (name.size() <= packing.ending.size() || !name.ends_with(packing.ending)) continue;
    const std::string text = file.string();
    const fs::path unpacked = text.substr(0, text.size() - packing.ending.size());
    return Unpacking{
        fmt::format(fmt::runtime(packing.command), shell_quoted(file), shell_quoted(unpacked)),
        unpacked};
  }
  return std::nullopt;
}

tl::unexpected<Error> packed_as_a_whole(const fs::path& file, const Unpacking& unpacking) {
  return fail(ErrorCode::kUnsupported, fmt::format("{}: packed as a whole", file.string()),
              fmt::format("unpack it first: `{}`, then give {}", unpacking.command,
                          shell_quoted(unpacking.unpacked)));
}

}  // namespace sgs::io
