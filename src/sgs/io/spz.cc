// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/spz.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <string>

#include "sgs/io/atomic_file.h"
#include "sgs/io/gzip.h"
#include "sgs/io/splat_check.h"
#include "sgs/io/spz_attributes.h"
#include "sgs/io/zstd.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "the headers are copied as they are");

constexpr std::uint32_t kMagic = 0x5053474e;  // "NGSP"
constexpr std::uint8_t kExtended = 2;         // flag: records of others before the table
// limit: SPZ after decompression, bytes
constexpr std::size_t kMaxBytes = std::size_t{1} << 31;

/// With which all versions begin, up to 3 within the gzip stream.
struct Header {
  std::uint32_t magic = kMagic;
  std::uint32_t version = 0;
  std::uint32_t count = 0;
  std::uint8_t harmonic_degree = 0, fractional_bits = 0, flags = 0;
  std::uint8_t streams = 0;  // of version 4, that are not empty
};
static_assert(sizeof(Header) == 16);

/// What follows in version 4.
struct MoreHeader {
  std::uint32_t table_offset = 0;  // from the file's begin
  std::uint32_t reserved[3] = {};
};
static_assert(sizeof(MoreHeader) == 16);

/// A line of the table: sizes in bytes of a stream as it is in the file, and as it was.
struct StreamSizes {
  std::uint64_t packed = 0, whole = 0;
};
static_assert(sizeof(StreamSizes) == 16);

template <class T>
void append(std::string& out, const T& value) {
  const std::size_t size = out.size();
  out.resize(size + sizeof value);
  std::memcpy(out.data() + size, &value, sizeof value);
}

/// False where `bytes` ends before.
template <class T>
bool read_at(std::string_view bytes, std::size_t offset, T& value) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof value) return false;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return true;
}

std::string as_gzip(const Header& header, const auto& attributes) {
  std::string out;
  append(out, header);
  for (const std::string& attribute : attributes) out += attribute;
  return gzip_compressed(out);
}

std::string as_zstd(Header header, const auto& attributes) {
  std::string table, streams;
  for (const std::string& attribute : attributes) {
    if (attribute.empty()) continue;
    const std::string packed = zstd_compressed(attribute);
    append(table, StreamSizes{packed.size(), attribute.size()});
    streams += packed;
    ++header.streams;
  }
  std::string out;
  append(out, header);
  append(out, MoreHeader{sizeof(Header) + sizeof(MoreHeader)});
  return out + table + streams;
}

using Attributes = std::array<std::string_view, SpzLayout::kAttributes>;

tl::unexpected<Error> bad_spz(const fs::path& path, const std::string& what) {
  return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", path.string(), what),
              "needed: an SPZ file of version 2, 3 or 4");
}

Result<SpzLayout> layout_of(const fs::path& path, const Header& header) {
  const SpzLayout layout{header.count, header.harmonic_degree, header.fractional_bits,
                         header.version > 2};
  if (header.magic != kMagic) return bad_spz(path, "no SPZ header");
  if (header.version < 2 || header.version > 4 ||
      header.harmonic_degree > map::kMaxHarmonicDegree || header.fractional_bits > 23) {
    return bad_spz(path, fmt::format("version {}, SH degree {}, {} fractional bits", header.version,
                                     header.harmonic_degree, header.fractional_bits));
  }
  return layout;
}

Result<map::SplatMap> from_gzip(const fs::path& path, std::string_view file) {
  const auto content = gzip_decompressed(file, kMaxBytes);
  if (!content) return bad_spz(path, "not a whole gzip stream");
  Header header;
  if (!read_at(*content, 0, header)) return bad_spz(path, "truncated header");
  SGS_ASSIGN_OR_RETURN(const SpzLayout layout, layout_of(path, header));
  const auto bytes = layout.bytes();
  const std::size_t needed = std::accumulate(bytes.begin(), bytes.end(), sizeof header);
  if (header.version > 3 || content->size() != needed) {
    return bad_spz(path, fmt::format("{} bytes for {} Gaussians of version {}", content->size(),
                                     layout.count, header.version));
  }
  Attributes attributes;
  std::string_view rest = std::string_view(*content).substr(sizeof header);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    attributes[i] = rest.substr(0, bytes[i]);
    rest.remove_prefix(bytes[i]);
  }
  return splats_from_spz(attributes, layout);
}

Result<map::SplatMap> from_zstd(const fs::path& path, std::string_view file) {
  Header header;
  MoreHeader more;
  if (!read_at(file, 0, header) || !read_at(file, sizeof header, more)) {
    return bad_spz(path, "truncated header");
  }
  SGS_ASSIGN_OR_RETURN(const SpzLayout layout, layout_of(path, header));
  const auto bytes = layout.bytes();
  if (header.version != 4 ||
      std::accumulate(bytes.begin(), bytes.end(), std::size_t{0}) > kMaxBytes) {
    return bad_spz(path, fmt::format("{} Gaussians of version {}", layout.count, header.version));
  }
  const std::size_t first = sizeof header + sizeof more;
  if (more.table_offset < first ||
      ((header.flags & kExtended) == 0 && more.table_offset != first)) {
    return bad_spz(path, fmt::format("its table begins at byte {}", more.table_offset));
  }
  std::array<std::string, SpzLayout::kAttributes> whole;
  std::size_t line = more.table_offset, at = line + header.streams * sizeof(StreamSizes);
  std::size_t streams = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (bytes[i] == 0) continue;
    StreamSizes sizes;
    if (++streams > header.streams || !read_at(file, line, sizes) || at > file.size() ||
        sizes.packed > file.size() - at || sizes.whole != bytes[i]) {
      return bad_spz(path, fmt::format("stream {} is missing or of another size", streams));
    }
    auto attribute = zstd_decompressed(file.substr(at, sizes.packed), bytes[i]);
    if (!attribute) return bad_spz(path, fmt::format("stream {} is damaged", streams));
    whole[i] = std::move(*attribute);
    line += sizeof sizes;
    at += sizes.packed;
  }
  if (streams != header.streams || at != file.size()) {
    return bad_spz(path, fmt::format("{} streams, {} of them used", header.streams, streams));
  }
  Attributes attributes;
  for (std::size_t i = 0; i < whole.size(); ++i) attributes[i] = whole[i];
  return splats_from_spz(attributes, layout);
}

}  // namespace

Status save_spz(const fs::path& path, std::span<const map::Gaussian> splats,
                const map::Harmonics& harmonics, SpzVersion version) {
  SGS_RETURN_IF_ERROR(check_splats(path, splats, harmonics));
  const auto bits = spz_fractional_bits(splats);
  if (!bits) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: coordinates beyond 8388 km do not fit", path.string()));
  }
  const bool gzip = version == SpzVersion::kGzip;
  Header header;
  header.version = static_cast<std::uint32_t>(version);
  header.count = static_cast<std::uint32_t>(splats.size());
  header.harmonic_degree = static_cast<std::uint8_t>(harmonics.degree);
  header.fractional_bits = static_cast<std::uint8_t>(*bits);
  const auto attributes =
      spz_attributes(splats, harmonics, {splats.size(), harmonics.degree, *bits, !gzip});
  return write_file(path, gzip ? as_gzip(header, attributes) : as_zstd(header, attributes));
}

Result<map::SplatMap> load_spz(const fs::path& path) {
  const auto file = read_file(path);
  if (!file) return tl::unexpected(file.error());
  return file->starts_with("NGSP") ? from_zstd(path, *file) : from_gzip(path, *file);
}

}  // namespace sgs::io
