// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/moving_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/alignment/movers/depth_segments.h"
#include "sgs/alignment/movers/static_score.h"
#include "sgs/alignment/movers/surface_check.h"

namespace sgs::alignment {
namespace {

// How old frames are that a frame is compared with: what moves slowly shows against older ones.
constexpr double kAges_s[] = {0.1, 0.3, 0.6};
constexpr double kKept_s = 0.7;
// By how much depth and colour may differ in time.
constexpr double kClock_s = 0.01;
// Shares of the measured cells: the least part that moves by itself; what has to move at least
// where nothing did, also cell by cell before anything is divided into parts.
constexpr double kLeastPart = 0.02, kOnset = 0.25, kLeastOff = 0.1;

// Depth in the cells of a SurfaceCheck.
std::vector<float> cell_depths(const DepthImage& depth, int columns, std::size_t count) {
  std::vector<float> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int x = static_cast<int>(i) % columns, y = static_cast<int>(i) / columns;
    out[i] = depth(x * SurfaceCheck::kCell + 1, y * SurfaceCheck::kCell + 1);
  }
  return out;
}

bool hardly_any_off(const std::vector<float>& off) {
  constexpr float kOff = 0.5f;
  const auto known = std::count_if(off.begin(), off.end(), [](float o) { return o >= 0; });
  const auto far = std::count_if(off.begin(), off.end(), [](float o) { return o > kOff; });
  return static_cast<double>(far) <= kLeastOff * static_cast<double>(known);
}

// The cells that hang together with `first` among those that are `open`, which are closed.
std::vector<std::size_t> take_part(std::size_t first, int columns,
                                   std::vector<std::uint8_t>& open) {
  std::vector<std::size_t> part{first};
  open[first] = 0;
  const auto visit = [&](std::size_t cell) {
    if (cell >= open.size() || open[cell] == 0) return;
    open[cell] = 0;
    part.push_back(cell);
  };
  const auto width = static_cast<std::size_t>(columns);
  for (std::size_t k = 0; k < part.size(); ++k) {
    const std::size_t cell = part[k];
    if (cell % width > 0) visit(cell - 1);
    if (cell % width + 1 < width) visit(cell + 1);
    if (cell >= width) visit(cell - width);
    visit(cell + width);
  }
  return part;
}

}  // namespace

// The nearest to each age; at first there are fewer.
std::vector<const CoarseDepth*> MovingParts::compared_with() const {
  std::vector<const CoarseDepth*> out;
  for (const double age : kAges_s) {
    const auto miss = [&](const CoarseDepth& d) {
      return std::abs(depth_.timestamp_s - d.timestamp_s - age);
    };
    const auto best = std::min_element(
        past_depths_.begin(), past_depths_.end(),
        [&](const CoarseDepth& a, const CoarseDepth& b) { return miss(a) < miss(b); });
    if (best == past_depths_.end()) break;
    if (std::find(out.begin(), out.end(), &*best) == out.end()) out.push_back(&*best);
  }
  return out;
}

MovingParts::Judgement MovingParts::judge(const SE3& T_local_camera,
                                          const registration::FrameMotion& motion,
                                          const LocalPast& past) {
  Judgement out;
  depth_.motion = motion;
  std::vector<float> off;
  int columns = 0;
  for (const CoarseDepth* then : compared_with()) {
    const SurfaceCheck check =
        check_surface(depth_, *then, past.at(then->frame).inverse() * T_local_camera, kClock_s);
    out.support += check.support;
    columns = check.columns;
    off.resize(check.off.size(), SurfaceCheck::kUnknown);
    for (std::size_t i = 0; i < off.size(); ++i) off[i] = std::max(off[i], check.off[i]);
  }
  if (off.empty() || (!moved() && hardly_any_off(off))) return out;
  const std::vector<float> depths = cell_depths(depth_.depth, columns, off.size());
  std::vector<float> still = score_still(segment_depth(depths, columns), off, still_);
  out.mask = coherent(still, depths, columns);
  if (out.mask.any()) out.still = std::move(still);
  return out;
}

// Parts that are too small are let go, and all where nothing moved and too little does now.
registration::CellMask MovingParts::coherent(const std::vector<float>& still,
                                             const std::vector<float>& depths, int columns) const {
  const auto measured = static_cast<double>(
      std::count_if(depths.begin(), depths.end(), [](float z) { return z > 0; }));
  std::vector<std::uint8_t> open(still.size()), moves(still.size(), 0);
  std::transform(still.begin(), still.end(), open.begin(),
                 [](float s) { return s < 0.5f ? std::uint8_t{1} : std::uint8_t{0}; });
  double moving = 0;
  for (std::size_t first = 0; first < open.size(); ++first) {
    if (open[first] == 0) continue;
    const std::vector<std::size_t> part = take_part(first, columns, open);
    if (static_cast<double>(part.size()) < kLeastPart * measured) continue;
    for (const std::size_t cell : part) moves[cell] = 1;
    moving += static_cast<double>(part.size());
  }
  if (moving < (moved() ? kLeastPart : kOnset) * measured) return {};
  return {depth_.step_px * SurfaceCheck::kCell, columns, std::move(moves)};
}

void MovingParts::remember(const Judgement& judgement, const registration::FrameMotion& motion) {
  depth_.motion = motion;
  still_ = judgement.still;
  past_depths_.push_back(depth_);
  while (depth_.timestamp_s - past_depths_.front().timestamp_s > kKept_s) {
    past_depths_.pop_front();
  }
}

}  // namespace sgs::alignment
