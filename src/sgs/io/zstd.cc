// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/zstd.h"

#include <zstd.h>

#include <algorithm>
#include <memory>

#include "sgs/core/error.h"

namespace sgs::io {

std::string zstd_compressed(std::string_view bytes) {
  constexpr int kLevel = 9;  // higher ones take several times as long for a few percent
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), kLevel);
  SGS_CHECK(!ZSTD_isError(size), "zstd could not compress");
  frame.resize(size);
  return frame;
}

std::optional<std::string> zstd_decompressed(std::string_view frame, std::size_t size) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                        ZSTD_freeDCtx);
  if (!context) return std::nullopt;
  std::string output;
  ZSTD_inBuffer in{frame.data(), frame.size(), 0};
  while (true) {
    // One byte more than is wanted: what holds more than that is found out.
    const std::size_t before = output.size();
    output.resize(std::min(before + ZSTD_DStreamOutSize(), size + 1));
    ZSTD_outBuffer out{output.data() + before, output.size() - before, 0};
    const std::size_t fed = in.pos;
    const std::size_t left = ZSTD_decompressStream(context.get(), &out, &in);
    output.resize(before + out.pos);
    if (ZSTD_isError(left) || output.size() > size) return std::nullopt;
    if (left == 0) break;
    if (out.pos == 0 && in.pos == fed) return std::nullopt;
  }
  if (in.pos != in.size || output.size() != size) return std::nullopt;
  return output;
}

}  // namespace sgs::io
