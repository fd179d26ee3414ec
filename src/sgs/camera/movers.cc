// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/movers.h"

#include <algorithm>
#include <utility>

#include "sgs/core/error.h"

namespace sgs {
namespace {

constexpr int kBlock_px = 8, kBits = 8;

int blocks_along(int pixels) { return (pixels + kBlock_px - 1) / kBlock_px; }
std::size_t bytes_of_blocks(int width, int height) {
  return static_cast<std::size_t>((blocks_along(width) * blocks_along(height) + kBits - 1) / kBits);
}

}  // namespace

std::shared_ptr<const PixelMask> in_both(const std::shared_ptr<const PixelMask>& a,
                                         const std::shared_ptr<const PixelMask>& b) {
  if (!a || !b || a == b) return a ? a : b;
  SGS_CHECK(a->width() == b->width() && a->height() == b->height(), "masks of one size");
  PixelMask out(a->width(), a->height());
  std::transform(a->data(), a->data() + a->size(), b->data(), out.data(),
                 [](std::uint8_t x, std::uint8_t y) {
                   return x != 0 && y != 0 ? std::uint8_t{1} : std::uint8_t{0};
                 });
  return std::make_shared<const PixelMask>(std::move(out));
}

void leave_out_movers(RgbdFrame& frame, const std::shared_ptr<const PixelMask>& still) {
  if (!still) return;
  SGS_CHECK(still->width() == frame.depth.width() && still->height() == frame.depth.height(),
            "a mask of the frame's size");
  std::transform(frame.depth.data(), frame.depth.data() + frame.depth.size(), still->data(),
                 frame.depth.data(),
                 [](float z, std::uint8_t stands) { return stands != 0 ? z : 0.0f; });
  frame.seen = in_both(frame.seen, still);
  frame.still = in_both(frame.still, still);
}

std::shared_ptr<const RgbdFrame> without_movers(const std::shared_ptr<const RgbdFrame>& frame,
                                                const std::shared_ptr<const PixelMask>& still) {
  if (!still) return frame;
  auto out = copy_to_change(frame);
  leave_out_movers(*out, still);
  return out;
}

std::string mover_blocks(const PixelMask& still) {
  std::string out(bytes_of_blocks(still.width(), still.height()), '\0');
  for (int v = 0; v < still.height(); ++v) {
    const int row = v / kBlock_px * blocks_along(still.width());
    for (int u = 0; u < still.width(); ++u) {
      if (still(u, v) != 0) continue;
      const int block = row + u / kBlock_px;
      char& byte = out[static_cast<std::size_t>(block / kBits)];
      byte = static_cast<char>(static_cast<unsigned char>(byte) | 1u << (block % kBits));
    }
  }
  return out;
}

std::shared_ptr<const PixelMask> still_from_blocks(std::string_view blocks, int width, int height) {
  if (blocks.size() != bytes_of_blocks(width, height)) return nullptr;
  PixelMask still(width, height, std::uint8_t{1});
  for (int v = 0; v < height; ++v) {
    const int row = v / kBlock_px * blocks_along(width);
    for (int u = 0; u < width; ++u) {
      const int block = row + u / kBlock_px;
      const auto byte = static_cast<unsigned char>(blocks[static_cast<std::size_t>(block / kBits)]);
      if ((byte >> (block % kBits) & 1u) != 0) still(u, v) = 0;
    }
  }
  return std::make_shared<const PixelMask>(std::move(still));
}

}  // namespace sgs
