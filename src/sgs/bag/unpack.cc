// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/unpack.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "sgs/bag/byte_file.h"
#include "sgs/core/text.h"

namespace sgs::bag {
namespace {

constexpr std::size_t kFirstOutput_bytes = 1 << 20;

tl::unexpected<Error> damaged(std::string_view compression) {
  return fail(ErrorCode::kInvalidFormat, fmt::format("a {} chunk is damaged", compression),
              "copy or record the file again");
}

/// Output that grows twofold up to the announced size, or to a size that it may have.
class Output {
 public:
  enum class Limit { kExact, kAtMost };
  explicit Output(std::uint64_t limit, Limit kind = Limit::kExact) : limit_(limit), kind_(kind) {
    grow(kFirstOutput_bytes);
  }
  char* free() { return bytes_.data() + used_; }
  std::size_t room() const { return bytes_.size() - used_; }
  bool full() const { return room() == 0 && used_ == limit_; }
  void use(std::size_t bytes) {
    used_ += bytes;
    if (room() == 0) grow(2 * bytes_.size());
  }
  Result<std::string> take(std::string_view compression) {
    if (kind_ == Limit::kExact && used_ != limit_) return damaged(compression);
    bytes_.resize(used_);
    return std::move(bytes_);
  }

 private:
  void grow(std::uint64_t bytes) { bytes_.resize(std::min(bytes, limit_)); }
  std::uint64_t limit_;
  Limit kind_;
  std::size_t used_ = 0;
  std::string bytes_;
};

Result<std::string> unpack_bz2(std::string_view packed, std::uint64_t announced) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return damaged("bz2");
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> closer(&stream, BZ2_bzDecompressEnd);
  stream.next_in = const_cast<char*>(packed.data());  // only read; the interface knows no const
  stream.avail_in = static_cast<unsigned>(packed.size());
  Output out(announced);
  int status = BZ_OK;
  while (status == BZ_OK) {
    char spill = 0;  // behind the announced end only the end mark may come
    const bool full = out.full();
    const auto room = static_cast<unsigned>(std::min<std::size_t>(out.room(), 1u << 30));
    stream.next_out = full ? &spill : out.free();
    stream.avail_out = full ? 1 : room;
    const unsigned in_before = stream.avail_in, out_before = stream.avail_out;
    status = BZ2_bzDecompress(&stream);
    const unsigned written = out_before - stream.avail_out;
    if (full && written > 0) return damaged("bz2");
    if (!full) out.use(written);
    if (status == BZ_OK && written == 0 && stream.avail_in == in_before) return damaged("bz2");
  }
  if (status != BZ_STREAM_END) return damaged("bz2");
  return out.take("bz2");
}

Result<std::string> unpack_lz4(std::string_view packed, std::uint64_t announced) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) return damaged("lz4");
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      raw, LZ4F_freeDecompressionContext);
  Output out(announced);
  std::size_t hint = 1;
  while (hint != 0) {
    char spill = 0;
    const bool full = out.full();
    std::size_t in = packed.size(), written = full ? 1 : out.room();
    hint = LZ4F_decompress(raw, full ? &spill : out.free(), &written, packed.data(), &in, nullptr);
    if (LZ4F_isError(hint) || (full && written > 0)) return damaged("lz4");
    if (!full) out.use(written);
    packed.remove_prefix(in);
    if (hint != 0 && in == 0 && written == 0) return damaged("lz4");
  }
  return out.take("lz4");
}

Result<std::string> unpack_zstd(std::string_view packed, Output out) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                        ZSTD_freeDCtx);
  if (!context) return damaged("zstd");
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::size_t hint = 1;
  while (hint != 0) {
    char spill = 0;
    const bool full = out.full();
    ZSTD_outBuffer to{full ? &spill : out.free(), full ? 1 : out.room(), 0};
    const std::size_t in_before = in.pos;
    hint = ZSTD_decompressStream(context.get(), &to, &in);
    if (ZSTD_isError(hint) || (full && to.pos > 0)) return damaged("zstd");
    if (!full) out.use(to.pos);
    if (hint != 0 && in.pos == in_before && to.pos == 0) return damaged("zstd");
  }
  return out.take("zstd");
}

}  // namespace

Result<std::string> unpack(std::string_view compression, std::string_view packed,
                           std::uint64_t announced) {
  if (announced > kLargestPiece_bytes) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("a chunk of {} bytes is larger than {}", announced, kLargestPiece_bytes),
        "the file is damaged; copy or record it again");
  }
  if (compression.empty() || compression == "none") {
    if (packed.size() != announced) return damaged("plain");
    return std::string(packed);
  }
  if (compression == "bz2") return unpack_bz2(packed, announced);
  if (compression == "lz4") return unpack_lz4(packed, announced);
  if (compression == "zstd") return unpack_zstd(packed, Output(announced));
  return fail(ErrorCode::kUnsupported,
              fmt::format("compression '{}' is not known", printable(shortened(compression))),
              "write the recording with none, lz4, bz2 or zstd");
}

bool is_zstd(std::string_view bytes) { return bytes.starts_with("\x28\xB5\x2F\xFD"); }

Result<std::string> unpack_zstd_frame(std::string_view packed) {
  return unpack_zstd(packed, Output(kLargestMessage_bytes, Output::Limit::kAtMost));
}

Result<std::string> message_content(std::string_view stored, Encoding encoding) {
  if (encoding == Encoding::kCdr && is_zstd(stored)) return unpack_zstd_frame(stored);
  return std::string(stored);
}

}  // namespace sgs::bag
