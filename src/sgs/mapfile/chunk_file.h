// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::mapfile {

/// Format of the map files that this version writes, and the latest that it reads. Kinds of chunks
/// that it does not know are passed over: only what changes the meaning of those that are there
/// needs another number.
inline constexpr int kFormat = 1;

/// What a chunk holds.
enum class ChunkKind : std::uint32_t { kHead = 1, kGaussians = 2, kView = 3, kGraph = 4 };

/// A row of a map file's table.
struct Chunk {
  ChunkKind kind = ChunkKind::kHead;
  std::array<std::int32_t, 3> cube = {};  ///< where it lies, in cubes of the map
  std::uint64_t count = 0;                ///< of the things in it
  std::uint64_t offset = 0;               ///< bytes from the beginning of the file
  std::uint64_t packed = 0;               ///< bytes in the file
  std::uint64_t raw = 0;                  ///< bytes unpacked
  std::uint32_t sum = 0;                  ///< CRC-32 of the packed bytes

  template <class Archive>
  void archive(Archive& a) {
    a(kind, cube, count, offset, packed, raw, sum);
  }
};

/// A chunk to be written.
struct ChunkContent {
  ChunkKind kind = ChunkKind::kHead;
  std::array<std::int32_t, 3> cube = {};
  std::uint64_t count = 0;
  std::string bytes;
};

/// The next one; empty at the end.
using NextChunk = std::function<std::optional<ChunkContent>()>;

/// Replaces `path` in one step by a file of these chunks: one is in memory at a time.
Status write_chunks(const std::filesystem::path& path, const NextChunk& next);

/// A map file whose every byte was checked: its length, its table, the sum of each chunk.
class ChunkFile {
 public:
  /// A file that is none, of a later format, cut off or damaged is refused by name.
  static Result<ChunkFile> open(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t bytes() const { return content_.size(); }
  const std::vector<Chunk>& chunks() const { return chunks_; }
  /// Of one kind, in the file's order.
  std::vector<Chunk> chunks(ChunkKind kind) const;
  /// What was written.
  Result<std::string> unpacked(const Chunk& chunk) const;

 private:
  std::filesystem::path path_;
  std::string content_;
  std::vector<Chunk> chunks_;
};

/// The error of a map file whose `what` is not as it was written.
tl::unexpected<Error> damaged(const std::filesystem::path& path, const std::string& what);

}  // namespace sgs::mapfile
