// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/moving_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/alignment/movers/depth_segments.h"
#include "sgs/alignment/movers/rigid_fit.h"
#include "sgs/alignment/movers/static_score.h"

namespace sgs::alignment {
namespace {

// How old frames are that a frame is compared with: what moves slowly shows against older ones.
constexpr double kAges_s[] = {0.1, 0.3, 0.6};
constexpr double kKept_s = 0.7;
// By how much depth and colour may differ in time.
constexpr double kClock_s = 0.01;
// How noisy depth is beside its model: so that of what stands still no more than a twentieth is
// off. Learned within some frames, forgotten within a second or two.
constexpr double kUsuallyOff = 0.05, kNoisier = 1.1, kCalmer = 0.98, kNoisiest = 4;
// By what a pose may be wrong, metres and radians together: no more is corrected by depth alone.
constexpr double kFarthest = 0.02;
// One cell of so many across and down is asked, as long as that shows nothing.
constexpr int kGlance = 2;
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

// Of what stands still, the share that is off all the same.
double off_of_what_stands(const std::vector<float>& off, const std::vector<float>& still) {
  constexpr float kOff = 0.25f;
  double known = 0, far = 0;
  for (std::size_t i = 0; i < off.size(); ++i) {
    if (off[i] < 0 || still[i] < 0.5f) continue;
    known += 1;
    far += off[i] > kOff ? 1 : 0;
  }
  return known > 0 ? far / known : 0;
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

void MovingParts::look_at(const RgbdFrame& frame) {
  depth_ = CoarseDepth(frame);
  if (moved()) nearest_m_ = nearest_measured(depth_);
}

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
    if (miss(*best) > kKept_s) continue;  // after a while without one
    if (std::find(out.begin(), out.end(), &*best) == out.end()) out.push_back(&*best);
  }
  return out;
}

MovingParts::Off MovingParts::check(const std::vector<Compared>& with, double clock_s,
                                    int stride) const {
  Off out;
  for (const Compared& older : with) {
    const SurfaceCheck check =
        check_surface(depth_, *older.then, older.T_then_now, {clock_s, noise_ratio_, stride});
    out.support += check.support;
    out.cells.resize(check.off.size(), SurfaceCheck::kUnknown);
    std::transform(check.off.begin(), check.off.end(), out.cells.begin(), out.cells.begin(),
                   [](float a, float b) { return std::max(a, b); });
    // Alone it is no reason to say that anything moves: who comes near a wall sees no depth either.
    if (moved()) check_covered(depth_, *older.then, older.T_then_now, nearest_m_, out.cells);
  }
  return out;
}

// What the pose and the clocks of depth and colour are wrong by is another motion of the camera,
// as depth tells it beside what moves.
std::vector<MovingParts::Compared> MovingParts::fitted(std::vector<Compared> with,
                                                       const registration::CellMask& moving) const {
  for (Compared& older : with) {
    const SE3 T = fit_rigid(depth_, *older.then, older.T_then_now, moving);
    if ((T * older.T_then_now.inverse()).log().norm() < kFarthest) older.T_then_now = T;
  }
  return with;
}

// What moves beside the camera is left over by any one motion, whosever it is.
bool MovingParts::one_motion_explains(std::vector<Compared> with) const {
  for (Compared& older : with) older.T_then_now = fit_rigid(depth_, *older.then, older.T_then_now);
  const Off off = check(with, kClock_s);
  if (hardly_any_off(off.cells)) return true;
  const std::vector<float> depths = cell_depths(depth_.depth, columns(), off.cells.size());
  return !coherent(score_still(segment_depth(depths, columns()), off.cells, {}), depths).any();
}

MovingParts::Judgement MovingParts::judge(const SE3& T_local_camera,
                                          const registration::FrameMotion& motion,
                                          const LocalPast& past) {
  Judgement out;
  depth_.motion = motion;
  std::vector<Compared> with;
  for (const CoarseDepth* then : compared_with()) {
    const SE3 T_then_now = past.at(then->frame).inverse() * T_local_camera;
    with.push_back({then, between_depths(depth_, *then, T_then_now)});
  }
  if (with.empty() || (!moved() && hardly_any_off(check(with, kClock_s, kGlance).cells)))
    return out;
  const Off off = check(with, kClock_s);
  out.support = off.support;
  if (!moved() && (hardly_any_off(off.cells) || one_motion_explains(with))) return out;
  const std::vector<float> depths = cell_depths(depth_.depth, columns(), off.cells.size());
  const DepthSegments segments = segment_depth(depths, columns());
  out.mask = coherent(score_still(segments, off.cells, still_), depths);
  if (!out.mask.any()) return out;
  const std::vector<float> cells = check(fitted(with, out.mask), 0).cells;
  std::vector<float> still = score_still(segments, cells, still_);
  out.mask = coherent(still, depths);
  if (!out.mask.any()) return out;
  out.off_share = off_of_what_stands(cells, still);
  out.still = std::move(still);
  return out;
}

// Masks are drawn a cell wider than what moves.
MovingParts::Judgement MovingParts::told(const registration::CellMask& moving) const {
  Judgement out;
  if (!moving.any()) return out;
  out.mask = moving;
  const int rim = moving.cell_px();
  const auto moves = [&](int u, int v) {
    return moving.at(u, v) && moving.at(std::max(0, u - rim), v) && moving.at(u + rim, v) &&
           moving.at(u, std::max(0, v - rim)) && moving.at(u, v + rim);
  };
  const int rows = depth_.depth.height() / SurfaceCheck::kCell;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns(); ++column) {
      const int u = (column * SurfaceCheck::kCell + 1) * depth_.step_px;
      const int v = (row * SurfaceCheck::kCell + 1) * depth_.step_px;
      out.still.push_back(moves(u, v) ? 0.0f : 1.0f);
    }
  }
  return out;
}

// Parts that are too small are let go, and all where nothing moved and too little does now.
registration::CellMask MovingParts::coherent(const std::vector<float>& still,
                                             const std::vector<float>& depths) const {
  const auto measured = static_cast<double>(
      std::count_if(depths.begin(), depths.end(), [](float z) { return z > 0; }));
  std::vector<std::uint8_t> open(still.size()), moves(still.size(), 0);
  std::transform(still.begin(), still.end(), open.begin(),
                 [](float s) { return s >= 0 && s < 0.5f ? std::uint8_t{1} : std::uint8_t{0}; });
  double moving = 0;
  for (std::size_t first = 0; first < open.size(); ++first) {
    if (open[first] == 0) continue;
    const std::vector<std::size_t> part = take_part(first, columns(), open);
    if (static_cast<double>(part.size()) < kLeastPart * measured) continue;
    for (const std::size_t cell : part) moves[cell] = 1;
    moving += static_cast<double>(part.size());
  }
  if (moving < (moved() ? kLeastPart : kOnset) * measured) return {};
  return {depth_.step_px * SurfaceCheck::kCell, columns(), std::move(moves)};
}

void MovingParts::remember(const Judgement& judgement, const registration::FrameMotion& motion) {
  depth_.motion = motion;
  still_ = judgement.still;
  if (moved()) {
    const double ratio = noise_ratio_ * (judgement.off_share > kUsuallyOff ? kNoisier : kCalmer);
    noise_ratio_ = std::clamp(ratio, 1.0, kNoisiest);
  }
  past_depths_.push_back(depth_);
  while (depth_.timestamp_s - past_depths_.front().timestamp_s > kKept_s) {
    past_depths_.pop_front();
  }
}

}  // namespace sgs::alignment
