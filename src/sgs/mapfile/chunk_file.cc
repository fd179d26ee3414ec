// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapfile/chunk_file.h"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <string_view>
#include <utility>

#include "sgs/core/archive.h"
#include "sgs/io/atomic_file.h"

namespace sgs::mapfile {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "map files are little-endian");

constexpr std::string_view kMagic = "sgs-map\n";
constexpr int kPackingLevel = 3;
// limit: a chunk of a map file, unpacked, bytes
constexpr std::uint64_t kLargestChunk_bytes = std::uint64_t{1} << 30;

/// At the very beginning and, with where the table lies, at the very end. Never changes with the
/// format.
struct Beginning {
  std::array<char, kMagic.size()> magic = {};
  std::int32_t format = kFormat;

  static constexpr std::size_t kSize = kMagic.size() + 4;
  template <class Archive>
  void archive(Archive& a) {
    a(magic, format);
  }
};
struct End {
  std::uint64_t table_length = 0;
  std::uint32_t table_sum = 0;
  Beginning again;

  static constexpr std::size_t kSize = 8 + 4 + Beginning::kSize;
  template <class Archive>
  void archive(Archive& a) {
    a(table_length, table_sum, again);
  }
};

Beginning beginning() {
  Beginning out;
  std::copy(kMagic.begin(), kMagic.end(), out.magic.begin());
  return out;
}

bool is_map(const Beginning& b) {
  return std::string_view(b.magic.data(), kMagic.size()) == kMagic;
}

std::uint32_t checksum(std::string_view bytes) {
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  return static_cast<std::uint32_t>(::crc32_z(::crc32_z(0, nullptr, 0), data, bytes.size()));
}

template <class T>
std::string bytes_of(T value) {
  ArchiveWriter bytes;
  bytes(value);
  return bytes.take();
}

template <class T>
T read_as(std::string_view bytes) {
  T value;
  ArchiveReader archive(bytes);
  archive(value);
  return value;
}

std::string packed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kPackingLevel);
  SGS_CHECK(ZSTD_isError(size) == 0, ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

std::string name_of(const Chunk& chunk) {
  switch (chunk.kind) {
    case ChunkKind::kHead:
      return "head";
    case ChunkKind::kGaussians:
      return fmt::format("cube {} {} {}", chunk.cube[0], chunk.cube[1], chunk.cube[2]);
    case ChunkKind::kGraph:
      return "graph";
    case ChunkKind::kView:
      return fmt::format("view at byte {}", chunk.offset);
  }
  return "chunk of a later version";
}

Status check_beginning(const fs::path& path, std::string_view content) {
  if (content.size() < Beginning::kSize || !is_map(read_as<Beginning>(content))) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{} is no map of sgs", path.string()),
                "give the map.sgsmap of a run folder, or the folder");
  }
  const std::int32_t format = read_as<Beginning>(content).format;
  if (format >= 1 && format <= kFormat) return {};
  return fail(ErrorCode::kUnsupported,
              fmt::format("{} is a map of format {}; this version of sgs reads up to {}",
                          path.string(), format, kFormat),
              "use the version of sgs that made it, or run its recording again");
}

}  // namespace

tl::unexpected<Error> damaged(const fs::path& path, const std::string& what) {
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{} is damaged: its {} is not as it was written", path.string(), what),
              "bring an unharmed copy, or run its recording again");
}

Status write_chunks(const fs::path& path, const NextChunk& next) {
  std::vector<Chunk> table;
  std::uint64_t offset = 0;
  bool ended = false;
  std::string block = bytes_of(beginning());
  const auto next_block = [&, first = true]() mutable -> std::string_view {
    if (std::exchange(first, false)) {
      offset = block.size();
      return block;
    }
    if (ended) return {};
    if (const auto content = next()) {
      block = packed(content->bytes);
      table.push_back({content->kind, content->cube, content->count, offset, block.size(),
                       content->bytes.size(), checksum(block)});
      offset += block.size();
      return block;
    }
    ended = true;
    block = bytes_of(table);
    block += bytes_of(End{block.size(), checksum(block), beginning()});
    return block;
  };
  return io::write_file_in_blocks(path, next_block);
}

Result<ChunkFile> ChunkFile::open(const fs::path& path) {
  ChunkFile file;
  file.path_ = path;
  SGS_ASSIGN_OR_RETURN(file.content_, io::read_file(path));
  std::string_view content = file.content_;
  SGS_RETURN_IF_ERROR(check_beginning(path, content));
  const auto cut_off = [&] { return damaged(path, "end (it was cut off, or something follows)"); };
  if (content.size() < Beginning::kSize + End::kSize) return cut_off();
  const auto end = read_as<End>(content.substr(content.size() - End::kSize));
  content.remove_suffix(End::kSize);
  const bool same = is_map(end.again) && end.again.format == read_as<Beginning>(content).format;
  if (!same || end.table_length > content.size() - Beginning::kSize) return cut_off();
  const auto table = content.substr(content.size() - end.table_length);
  content.remove_suffix(table.size());
  ArchiveReader archive(table);
  archive(file.chunks_);
  if (checksum(table) != end.table_sum || !archive.complete()) return damaged(path, "table");
  std::uint64_t offset = Beginning::kSize;
  for (const Chunk& chunk : file.chunks_) {
    if (chunk.offset != offset || chunk.packed > content.size() - offset) {
      return damaged(path, "table");
    }
    offset += chunk.packed;
    if (checksum(content.substr(chunk.offset, chunk.packed)) != chunk.sum) {
      return damaged(path, name_of(chunk));
    }
  }
  if (offset != content.size()) return damaged(path, "table");
  return file;
}

std::vector<Chunk> ChunkFile::chunks(ChunkKind kind) const {
  std::vector<Chunk> out;
  std::copy_if(chunks_.begin(), chunks_.end(), std::back_inserter(out),
               [&](const Chunk& chunk) { return chunk.kind == kind; });
  return out;
}

Result<std::string> ChunkFile::unpacked(const Chunk& chunk) const {
  if (chunk.raw > kLargestChunk_bytes) return damaged(path_, name_of(chunk));
  std::string out(chunk.raw, '\0');
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), content_.data() + chunk.offset,
                                           static_cast<std::size_t>(chunk.packed));
  if (ZSTD_isError(size) != 0 || size != chunk.raw) return damaged(path_, name_of(chunk));
  return out;
}

}  // namespace sgs::mapfile
