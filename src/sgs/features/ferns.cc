// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/features/ferns.h"

#include <algorithm>
#include <array>

#include "sgs/core/error.h"
#include "sgs/core/random.h"

namespace sgs::features {
namespace {

constexpr int kColumns = 40, kRows = 30;

/// Means over the cells of a coarse raster.
struct CoarseView {
  std::array<float, kColumns * kRows> gray{}, redness{}, depth{};  // depth 0 = none
};

CoarseView reduce(const RgbdFrame& frame) {
  CoarseView out;
  const int w = frame.color.width(), h = frame.color.height();
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const int x0 = column * w / kColumns, x1 = std::max(x0 + 1, (column + 1) * w / kColumns);
      const int y0 = row * h / kRows, y1 = std::max(y0 + 1, (row + 1) * h / kRows);
      float sum = 0, red = 0, depth = 0;
      int measured = 0, seen = 0;
      for (int y = y0; y < std::min(y1, h); ++y) {
        for (int x = x0; x < std::min(x1, w); ++x) {
          if (frame.sees(x, y)) {
            const Rgb8& c = frame.color(x, y);
            sum += static_cast<float>(c.r + c.g + c.b);
            red += static_cast<float>(c.r);
            ++seen;
          }
          const float z = frame.depth(x, y);
          depth += z;
          measured += z > 0 ? 1 : 0;
        }
      }
      const auto cell = static_cast<std::size_t>(row * kColumns + column);
      const int pixels = (x1 - x0) * (y1 - y0);
      // As if all of the cell was as bright as what was seen of it.
      out.gray[cell] =
          seen < pixels ? sum * static_cast<float>(pixels) / static_cast<float>(std::max(seen, 1))
                        : sum;
      out.redness[cell] = red / std::max(sum, 1.0f);
      out.depth[cell] = 2 * measured >= pixels ? depth / static_cast<float>(measured) : 0.0f;
    }
  }
  return out;
}

}  // namespace

Ferns::Ferns(std::uint64_t seed, int count) {
  SGS_CHECK(count > 0, "at least one fern");
  SplitMix64 random(seed);
  const auto cell = [&] { return static_cast<int>(random.below(kColumns * kRows)); };
  const auto pair = [&] {
    Pair p{cell(), cell()};
    while (p.b == p.a) p.b = cell();
    return p;
  };
  for (int i = 0; i < count; ++i) {
    Fern f;
    f.gray[0] = pair();
    f.gray[1] = pair();
    f.redness = pair();
    f.depth = pair();
    ferns_.push_back(f);
  }
}

FernCode Ferns::code(const RgbdFrame& frame) const {
  const CoarseView view = reduce(frame);
  const auto more = [](const auto& values, const Pair& p) {
    return values[static_cast<std::size_t>(p.a)] > values[static_cast<std::size_t>(p.b)] ? 1u : 0u;
  };
  FernCode out;
  out.reserve(ferns_.size());
  for (const Fern& f : ferns_) {
    const bool measured = view.depth[static_cast<std::size_t>(f.depth.a)] > 0 &&
                          view.depth[static_cast<std::size_t>(f.depth.b)] > 0;
    const unsigned bits = more(view.gray, f.gray[0]) | more(view.gray, f.gray[1]) << 1 |
                          more(view.redness, f.redness) << 2 | more(view.depth, f.depth) << 3;
    out.push_back(measured ? static_cast<std::uint8_t>(bits) : kUnknown);
  }
  return out;
}

double Ferns::similarity(const FernCode& a, const FernCode& b) {
  SGS_CHECK(a.size() == b.size(), "codes of the same ferns");
  int known = 0, equal = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool both = a[i] != kUnknown && b[i] != kUnknown;
    known += both ? 1 : 0;
    equal += both && a[i] == b[i] ? 1 : 0;
  }
  constexpr int kFewest = 8;  // one fern in so many must be answered
  if (known * kFewest < static_cast<int>(a.size())) return 0;
  return static_cast<double>(equal) / known;
}

}  // namespace sgs::features
