// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::io {
namespace {

constexpr int kGzipWindow = 15 + 16;  // zlib: 16 on top of the window's bits asks for gzip
constexpr std::size_t kChunk = 1 << 16;

/// Calls `step` (deflate or inflate) until it ends, feeding input and collecting output in chunks.
/// False on an error, on missing input and beyond `max_bytes`.
template <class Step>
bool pump(z_stream& stream, std::string_view input, std::string& output, std::size_t max_bytes,
          const Step& step) {
  std::vector<Bytef> in(input.begin(), input.end()), out(kChunk);
  std::size_t fed = 0;
  while (true) {
    if (stream.avail_in == 0 && fed < in.size()) {
      const std::size_t size = std::min(kChunk, in.size() - fed);
      stream.next_in = in.data() + fed;
      stream.avail_in = static_cast<uInt>(size);
      fed += size;
    }
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    const int code = step(fed == in.size());
    const std::size_t got = out.size() - stream.avail_out;
    if (output.size() + got > max_bytes) return false;
    output.append(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(got));
    if (code == Z_STREAM_END) return true;
    if (code != Z_OK) return false;
    if (got == 0 && stream.avail_in == 0 && fed == in.size()) return false;
  }
}

}  // namespace

std::string gzip_compressed(std::string_view bytes) {
  z_stream stream{};
  const int started =
      deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, 9, Z_DEFAULT_STRATEGY);
  SGS_CHECK(started == Z_OK, "zlib could not start");
  std::string output;
  const bool done = pump(stream, bytes, output, output.max_size(),
                         [&](bool last) { return deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH); });
  deflateEnd(&stream);
  SGS_CHECK(done, "zlib could not compress");
  return output;
}

std::optional<std::string> gzip_decompressed(std::string_view bytes, std::size_t max_bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzipWindow) != Z_OK) return std::nullopt;
  std::string output;
  const bool done =
      pump(stream, bytes, output, max_bytes, [&](bool) { return inflate(&stream, Z_NO_FLUSH); });
  inflateEnd(&stream);
  if (!done) return std::nullopt;
  return output;
}

std::optional<std::string> zlib_decompressed(std::string_view bytes, std::size_t size) {
  std::string output(size, '\0');
  uLongf written = static_cast<uLongf>(size);
  const int code =
      uncompress(reinterpret_cast<Bytef*>(output.data()), &written,
                 reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()));
  if (code != Z_OK || written != size) return std::nullopt;
  return output;
}

}  // namespace sgs::io
