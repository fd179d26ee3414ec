// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/seen_area.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace sgs {

// The largest rectangle under a histogram, row by row: `heights` are the seen pixels above each
// column, and a stack keeps the columns whose height is not yet bounded on the right.
PixelArea largest_seen_area(const PixelMask& seen) {
  PixelArea best;
  const int width = seen.width();
  std::vector<int> heights(static_cast<std::size_t>(width) + 1, 0);  // the last stays 0
  for (int y = 0; y < seen.height(); ++y) {
    for (int x = 0; x < width; ++x) {
      int& h = heights[static_cast<std::size_t>(x)];
      h = seen(x, y) != 0 ? h + 1 : 0;
    }
    std::vector<std::pair<int, int>> open;  // first column, height
    for (int x = 0; x <= width; ++x) {
      const int h = heights[static_cast<std::size_t>(x)];
      int first = x;
      while (!open.empty() && open.back().second >= h) {
        first = open.back().first;
        const PixelArea area{first, y + 1 - open.back().second, x - first, open.back().second};
        if (area.width * area.height > best.width * best.height) best = area;
        open.pop_back();
      }
      if (h > 0) open.emplace_back(first, h);
    }
  }
  return best;
}

double seen_share(const PixelMask& seen) {
  if (seen.empty()) return 1;
  const auto count = std::count_if(seen.data(), seen.data() + seen.size(),
                                   [](std::uint8_t value) { return value != 0; });
  return static_cast<double>(count) / static_cast<double>(seen.size());
}

ColorImage cropped(const ColorImage& picture, const PixelArea& area) {
  ColorImage out(area.width, area.height);
  for (int y = 0; y < area.height; ++y) {
    std::copy_n(picture.row(area.y + y) + area.x, area.width, out.row(y));
  }
  return out;
}

}  // namespace sgs
