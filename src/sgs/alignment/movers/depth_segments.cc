// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/depth_segments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace sgs::alignment {
namespace {

constexpr int kSegmentCells = 5;  // between the first centres
constexpr int kSweeps = 3;
constexpr float kApart = 0.05f;     // ratio of depths that counts as much as kSegmentCells
constexpr float kTouching = 0.03f;  // largest ratio of depths across a border on one surface

struct Centre {
  float x = 0, y = 0, log_z = 0;
};

float as_float(int x) { return static_cast<float>(x); }

/// The cells and the centres that they gather around.
class Clusters {
 public:
  Clusters(const std::vector<float>& depth, int columns)
      : columns_(columns),
        rows_(static_cast<int>(depth.size()) / columns),
        across_((columns_ + kSegmentCells - 1) / kSegmentCells),
        down_((rows_ + kSegmentCells - 1) / kSegmentCells),
        log_z_(depth.size()),
        of_(depth.size(), DepthSegments::kNone) {
    for (std::size_t i = 0; i < depth.size(); ++i) {
      log_z_[i] = depth[i] > 0 ? std::log(depth[i]) : std::numeric_limits<float>::quiet_NaN();
    }
    for (int j = 0; j < down_; ++j) {
      for (int i = 0; i < across_; ++i) {
        const int x = std::min(i * kSegmentCells + kSegmentCells / 2, columns_ - 1);
        const int y = std::min(j * kSegmentCells + kSegmentCells / 2, rows_ - 1);
        const float log_z = log_z_[cell(x, y)];
        centres_.push_back({as_float(x), as_float(y), std::isnan(log_z) ? 0 : log_z});
      }
    }
  }

  void assign() {
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        if (!std::isnan(log_z_[cell(x, y)])) of_[cell(x, y)] = nearest(x, y);
      }
    }
  }

  void move_centres() {
    std::vector<Centre> sums(centres_.size());
    std::vector<int> counts(centres_.size(), 0);
    for (std::size_t i = 0; i < of_.size(); ++i) {
      if (of_[i] == DepthSegments::kNone) continue;
      const auto s = static_cast<std::size_t>(of_[i]);
      sums[s].x += as_float(static_cast<int>(i) % columns_);
      sums[s].y += as_float(static_cast<int>(i) / columns_);
      sums[s].log_z += log_z_[i];
      ++counts[s];
    }
    for (std::size_t s = 0; s < centres_.size(); ++s) {
      if (counts[s] == 0) continue;
      const float n = as_float(counts[s]);
      centres_[s] = {sums[s].x / n, sums[s].y / n, sums[s].log_z / n};
    }
  }

  DepthSegments result() && {
    std::map<std::pair<int, int>, float> borders;
    const auto touch = [&](std::size_t a, std::size_t b) {
      const int s = of_[a], t = of_[b];
      if (s == t || s < 0 || t < 0 || std::abs(log_z_[a] - log_z_[b]) > kTouching) return;
      borders[{std::min(s, t), std::max(s, t)}] += 1;
    };
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        if (x + 1 < columns_) touch(cell(x, y), cell(x + 1, y));
        if (y + 1 < rows_) touch(cell(x, y), cell(x, y + 1));
      }
    }
    DepthSegments out;
    out.count = across_ * down_;
    out.of = std::move(of_);
    for (const auto& [pair, length] : borders) {
      out.borders.push_back(
          {static_cast<std::size_t>(pair.first), static_cast<std::size_t>(pair.second), length});
    }
    return out;
  }

 private:
  std::size_t cell(int x, int y) const { return static_cast<std::size_t>(y * columns_ + x); }

  // Of the centres that began around a cell.
  std::int16_t nearest(int x, int y) const {
    float best = std::numeric_limits<float>::infinity();
    int out = DepthSegments::kNone;
    const int column = x / kSegmentCells, row = y / kSegmentCells;
    for (int j = std::max(0, row - 1); j <= std::min(down_ - 1, row + 1); ++j) {
      for (int i = std::max(0, column - 1); i <= std::min(across_ - 1, column + 1); ++i) {
        const Centre& c = centres_[static_cast<std::size_t>(j * across_ + i)];
        const float dx = (as_float(x) - c.x) / kSegmentCells;
        const float dy = (as_float(y) - c.y) / kSegmentCells;
        const float dz = (log_z_[cell(x, y)] - c.log_z) / kApart;
        const float distance = dx * dx + dy * dy + dz * dz;
        if (!(distance < best)) continue;
        best = distance;
        out = j * across_ + i;
      }
    }
    return static_cast<std::int16_t>(out);
  }

  int columns_, rows_, across_, down_;
  std::vector<float> log_z_;
  std::vector<std::int16_t> of_;
  std::vector<Centre> centres_;
};

}  // namespace

DepthSegments segment_depth(const std::vector<float>& depth, int columns) {
  Clusters clusters(depth, columns);
  for (int i = 0; i < kSweeps; ++i) {
    clusters.assign();
    clusters.move_centres();
  }
  return std::move(clusters).result();
}

}  // namespace sgs::alignment
