// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/movers/depth_segments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace sgs::tracker {
namespace {

constexpr int kSegmentCells = 5;           // cells between the first centres
constexpr int kSweeps = 3;
constexpr float kApart = 0.05f;    // ratio of depths that counts as much as kSegmentCells cells
constexpr float kTouching = 0.03f;  // largest ratio of depths across a border on one surface

struct Centre {
  float x = 0, y = 0, log_z = 0;
};

}  // namespace

DepthSegments segment_depth(const std::vector<float>& depth, int columns) {
  const int rows = static_cast<int>(depth.size()) / columns;
  const int across = (columns + kSegmentCells - 1) / kSegmentCells, down = (rows + kSegmentCells - 1) / kSegmentCells;
  std::vector<float> log_z(depth.size());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    log_z[i] = depth[i] > 0 ? std::log(depth[i]) : std::numeric_limits<float>::quiet_NaN();
  }
  const auto f = [](int x) { return static_cast<float>(x); };
  DepthSegments out;
  out.count = across * down;
  out.of.assign(depth.size(), DepthSegments::kNone);
  std::vector<Centre> centres(static_cast<std::size_t>(out.count));
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      const int x = std::min(i * kSegmentCells + kSegmentCells / 2, columns - 1);
      const int y = std::min(j * kSegmentCells + kSegmentCells / 2, rows - 1);
      const float z = log_z[static_cast<std::size_t>(y * columns + x)];
      centres[static_cast<std::size_t>(j * across + i)] = {f(x), f(y), std::isnan(z) ? 0 : z};
    }
  }
  for (int round = 0; round < kSweeps; ++round) {
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const auto cell = static_cast<std::size_t>(y * columns + x);
        if (std::isnan(log_z[cell])) continue;
        float best = std::numeric_limits<float>::infinity();
        for (int j = std::max(0, y / kSegmentCells - 1); j <= std::min(down - 1, y / kSegmentCells + 1); ++j) {
          for (int i = std::max(0, x / kSegmentCells - 1); i <= std::min(across - 1, x / kSegmentCells + 1); ++i) {
            const Centre& c = centres[static_cast<std::size_t>(j * across + i)];
            const float dx = (f(x) - c.x) / f(kSegmentCells), dy = (f(y) - c.y) / f(kSegmentCells);
            const float dz = (log_z[cell] - c.log_z) / kApart;
            const float distance = dx * dx + dy * dy + dz * dz;
            if (!(distance < best)) continue;
            best = distance;
            out.of[cell] = static_cast<std::int16_t>(j * across + i);
          }
        }
      }
    }
    std::vector<Centre> sums(centres.size());
    std::vector<int> counts(centres.size(), 0);
    for (std::size_t cell = 0; cell < depth.size(); ++cell) {
      if (out.of[cell] == DepthSegments::kNone) continue;
      const auto s = static_cast<std::size_t>(out.of[cell]);
      sums[s].x += f(static_cast<int>(cell) % columns);
      sums[s].y += f(static_cast<int>(cell) / columns);
      sums[s].log_z += log_z[cell];
      ++counts[s];
    }
    for (std::size_t s = 0; s < centres.size(); ++s) {
      if (counts[s] == 0) continue;
      const float n = f(counts[s]);
      centres[s] = {sums[s].x / n, sums[s].y / n, sums[s].log_z / n};
    }
  }
  std::map<std::pair<int, int>, float> borders;
  const auto touch = [&](std::size_t a, std::size_t b) {
    const int s = out.of[a], t = out.of[b];
    if (s == t || s < 0 || t < 0 || std::abs(log_z[a] - log_z[b]) > kTouching) return;
    borders[std::minmax(s, t)] += 1;
  };
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const auto cell = static_cast<std::size_t>(y * columns + x);
      if (x + 1 < columns) touch(cell, cell + 1);
      if (y + 1 < rows) touch(cell, cell + static_cast<std::size_t>(columns));
    }
  }
  for (const auto& [pair, length] : borders) out.borders.push_back({pair.first, pair.second, length});
  return out;
}

}  // namespace sgs::tracker
