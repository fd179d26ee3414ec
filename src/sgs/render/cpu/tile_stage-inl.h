// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// First step of a tile visit: bring its Gaussians in, find for each the 4x4 blocks that its ellipse
// of alpha = 1/255 really touches, and list for each block those that touch it.

#if defined(SGS_RENDER_CPU_TILE_STAGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SGS_RENDER_CPU_TILE_STAGE_INL_H_
#undef SGS_RENDER_CPU_TILE_STAGE_INL_H_
#else
#define SGS_RENDER_CPU_TILE_STAGE_INL_H_
#endif

#include <cstring>

#include "sgs/render/cpu/lanes-inl.h"
#include "sgs/render/cpu/tile.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

/// Which blocks of a tile each of kLanes Gaussians touches: bit 8 row + column, rows 0-3 in `low`,
/// 4-7 in `high`.
struct BlockMasks {
  VI low, high;
};

/// The blocks that the ellipse overlaps in the tile whose first pixel is (tile_x0, tile_y0). `s`
/// holds kLanes records by column.
///
/// In a strip of pixel rows [ya, yb] relative to the mean, the ellipse reaches from the smallest
/// to the largest of -tilt' y -+ sqrt(w2 - q y^2) at both ends, or its leftmost and rightmost
/// point where those lie inside.
HWY_INLINE BlockMasks block_masks(const F* s, float tile_x0, float tile_y0) {
  const F ox = s[0] - F(tile_x0), oy = s[1] - F(tile_y0);
  const F ex = s[10], ey = s[11], half_width2 = s[15];
  const F zero(0.0f), minus_ey = zero - ey, minus_ex = zero - ex;
  const F slope = F(-0.5f) * s[3] / s[2];
  const F q = half_width2 / (ey * ey);
  const F y_right = s[14] * ex, y_left = zero - y_right;
  const VI one = hn::Set(kI, 1), two = hn::Set(kI, 2);
  BlockMasks out = {hn::Zero(kI), hn::Zero(kI)};
  for (int row = 0; row < kTileBlocks; ++row) {
    const F y0 = F(static_cast<float>(row * kBlockSide)) - oy, y1 = y0 + F(3.0f);
    const F ya = minimum(maximum(y0, minus_ey), ey), yb = minimum(maximum(y1, minus_ey), ey);
    const F sa = square_root(maximum(zero, neg_mul_add(q * ya, ya, half_width2)));
    const F sb = square_root(maximum(zero, neg_mul_add(q * yb, yb, half_width2)));
    F right = maximum(mul_add(slope, ya, sa), mul_add(slope, yb, sb));
    F left = minimum(mul_add(slope, ya, zero - sa), mul_add(slope, yb, zero - sb));
    right = select(hn::And(ya <= y_right, y_right <= yb), ex, right);
    left = select(hn::And(ya <= y_left, y_left <= yb), minus_ex, left);
    // First and last pixel column; the slack of a thousandth of a pixel covers rounding.
    const F last = minimum(maximum(right + ox + F(1e-3f), F(-1.0f)), F(kTileSide - 1.0f));
    const F first = minimum(maximum(left + ox - F(1e-3f), zero), F(static_cast<float>(kTileSide)));
    const VI i1 = hn::ConvertTo(kI, hn::Floor(last.v)), i0 = hn::ConvertTo(kI, hn::Ceil(first.v));
    const auto touched = hn::And(hn::Lt(i0, hn::Add(i1, one)),
                                 hn::RebindMask(kI, hn::And(y1 >= minus_ey, y0 <= ey)));
    const VI b1 = hn::Max(hn::ShiftRight<2>(i1), hn::Zero(kI)), b0 = hn::ShiftRight<2>(i0);
    VI bits = hn::Sub(hn::Shl(two, b1), hn::Shl(one, b0));
    bits = hn::IfThenElseZero(touched, bits);
    const VI shift = hn::Set(kI, 8 * (row & 3));
    VI& half = row < 4 ? out.low : out.high;
    half = hn::Or(half, hn::Shl(bits, shift));
  }
  return out;
}

/// For each mask of eight lanes the numbers of its lanes, lowest first, four bits each.
struct LaneNumbers {
  std::uint32_t of[256];
};
constexpr LaneNumbers make_lane_numbers() {
  LaneNumbers out{};
  for (std::uint32_t mask = 0; mask < 256; ++mask) {
    int shift = 0;
    for (std::uint32_t lane = 0; lane < 8; ++lane) {
      if ((mask >> lane & 1) == 0) continue;
      out.of[mask] |= lane << shift;
      shift += 4;
    }
  }
  return out;
}
inline constexpr LaneNumbers kLaneNumbers = make_lane_numbers();

/// Appends the Gaussians with numbers first, first + 1, ... to the lists of the 32 blocks whose
/// bits are set in their lanes of `bits`.
HWY_INLINE void append_to_lists(VI bits, std::uint32_t first, std::uint32_t* lists,
                                std::uint32_t* counts) {
  const hn::RebindToUnsigned<FloatTag> u32;
  // Whole vectors are written; what lies behind the end is overwritten or never read.
  if constexpr (kLanes == 16) {
    const auto masks = hn::BitCast(u32, bits);
    const auto numbers = hn::Iota(u32, first);
    auto bit = hn::Set(u32, 1u);
    for (int b = 0; b < 32; ++b) {
      const auto touching = hn::TestBit(masks, bit);
      hn::StoreU(hn::Compress(numbers, touching), u32,
                 lists + static_cast<std::uint32_t>(b) * kListStride + counts[b]);
      counts[b] += static_cast<std::uint32_t>(hn::CountTrue(u32, touching));
      bit = hn::Add(bit, bit);
    }
  } else if constexpr (kLanes == 8) {
    // Own table: that of Highway's Compress is copied to the stack at each call by GCC 12.
    alignas(32) constexpr std::uint32_t kShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
    const auto masks = hn::BitCast(u32, bits);
    const auto shifts = hn::Load(u32, kShifts), nibble = hn::Set(u32, 15u);
    const auto base = hn::Set(u32, first);
    auto bit = hn::Set(u32, 1u);
    for (int b = 0; b < 32; ++b) {
      alignas(8) std::uint8_t touching[8] = {};
      hn::StoreMaskBits(u32, hn::TestBit(masks, bit), touching);
      const auto packed = hn::Set(u32, kLaneNumbers.of[touching[0]]);
      hn::StoreU(hn::Add(base, hn::And(hn::Shr(packed, shifts), nibble)), u32,
                 lists + static_cast<std::uint32_t>(b) * kListStride + counts[b]);
      counts[b] += static_cast<std::uint32_t>(__builtin_popcount(touching[0]));
      bit = hn::Add(bit, bit);
    }
  } else {
    alignas(16) std::uint32_t masks[4];
    hn::Store(hn::BitCast(u32, bits), u32, masks);
    for (std::uint32_t l = 0; l < kLanes; ++l) {
      for (std::uint32_t m = masks[l]; m != 0; m &= m - 1) {
        const auto b = static_cast<std::uint32_t>(__builtin_ctz(m));
        lists[b * kListStride + counts[b]++] = first + l;
      }
    }
  }
}

/// Slot of the sums of a Gaussian in this tile: its tiles are numbered row by row.
HWY_INLINE std::uint32_t slot_of(const TileJob& job, std::uint32_t id) {
  const Record& r = job.records[id];
  const int ordinal =
      (job.tile_y - r.rect.y0) * (r.rect.x1 - r.rect.x0 + 1) + job.tile_x - r.rect.x0;
  return job.slot_base[id >> kChunkShift] + r.slot + static_cast<std::uint32_t>(ordinal);
}

/// Stages entries [begin, end) of `count` and lists them by block (those of `live` only); `counts`
/// gets the lengths of the lists.
HWY_INLINE void stage_batch(const TileJob& job, const std::uint32_t* entries, std::uint32_t begin,
                            std::uint32_t end, std::uint32_t count, std::uint64_t live,
                            TileScratch& scratch, std::uint32_t* counts) {
  constexpr std::uint32_t kAhead = 32;
  constexpr int kHalf = kBlocksPerTile / 2;
  const auto x0 = static_cast<float>(job.tile_x * kTileSide);
  const auto y0 = static_cast<float>(job.tile_y * kTileSide);
  Staged* staged = scratch.staged.data();
  std::uint32_t* lists = scratch.block_list.data();
  const VI live_low = hn::Set(kI, static_cast<std::int32_t>(live));
  const VI live_high = hn::Set(kI, static_cast<std::int32_t>(live >> kHalf));
  std::memset(counts, 0, kBlocksPerTile * sizeof *counts);
  for (std::uint32_t i = begin; i < end; i += kLanes) {
    const std::uint32_t n = end - i < kLanes ? end - i : kLanes;
    const float* rows[kLanes];
    for (std::uint32_t l = 0; l < kLanes; ++l) {
      rows[l] = &job.records[entries[i + (l < n ? l : 0)]].x;
      if (i + kAhead + l < count) __builtin_prefetch(&job.records[entries[i + kAhead + l]]);
    }
    F s[16];
    load_columns(rows, s);
    BlockMasks masks = block_masks(s, x0, y0);
    const auto present = hn::RebindMask(kI, hn::FirstN(kF, n));
    masks.low = hn::IfThenElseZero(present, hn::And(masks.low, live_low));
    masks.high = hn::IfThenElseZero(present, hn::And(masks.high, live_high));
    hn::StoreU(masks.low, kI, reinterpret_cast<std::int32_t*>(scratch.active[0].data() + i));
    hn::StoreU(masks.high, kI, reinterpret_cast<std::int32_t*>(scratch.active[1].data() + i));
    append_to_lists(masks.low, i - begin, lists, counts);
    append_to_lists(masks.high, i - begin, lists + kHalf * kListStride, counts + kHalf);
    for (std::uint32_t l = 0; l < n; ++l) {
      float* to = &staged[i + l].x;
      for (int part = 0; part < kParts; ++part) {
        store(load(rows[l] + part * kLanes), to + part * kLanes);
      }
      to[0] = x0 - rows[l][0];
      to[1] = y0 - rows[l][1];
      if (job.training != nullptr) scratch.slots.data()[i + l] = slot_of(job, entries[i + l]);
    }
  }
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
