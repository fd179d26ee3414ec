// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/target_shortlist.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgs::registration {
namespace {

// The camera may turn and move by this much before all targets are looked through again. The field
// of view is widened by what that brings into view from this distance on; nearer targets may be
// missed at the border until then.
constexpr double kTurn_rad = 0.05, kShift_m = 0.05, kNear_m = 0.7;
// What lies deeper than this behind the nearest target around it cannot be seen.
constexpr float kBehind_m = 0.05f;

/// The widening on each side, in cells.
int margin(const CellCamera& camera) {
  const double focal = std::max(camera.fx, camera.fy);
  return static_cast<int>(std::ceil(focal * (kTurn_rad + kShift_m / kNear_m)));
}

CellCamera widened(CellCamera camera) {
  const auto by = static_cast<float>(margin(camera));
  camera.cx += by;
  camera.cy += by;
  return camera;
}

}  // namespace

void GrowingArrays::resize(std::size_t count) {
  for (auto& array : arrays_) array.resize(count);
}

void GrowingArrays::push_back(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) {
  for (int axis = 0; axis < 3; ++axis) {
    arrays_[axis].push_back(point[axis]);
    arrays_[3 + axis].push_back(normal[axis]);
  }
}

void GrowingArrays::push_back(const GrowingArrays& from, std::size_t i) {
  for (int k = 0; k < 6; ++k) arrays_[k].push_back(from.arrays_[k][i]);
}

void GrowingArrays::assign(const GrowingArrays& from, std::span<const int> indices) {
  resize(indices.size());
  for (int k = 0; k < 6; ++k) {
    const float* source = from.arrays_[k].data();
    std::transform(indices.begin(), indices.end(), arrays_[k].begin(),
                   [source](int i) { return source[i]; });
  }
}

void GrowingArrays::clear_normal(std::size_t i) {
  for (int axis = 0; axis < 3; ++axis) arrays_[3 + axis][i] = 0;
}

PointArrays GrowingArrays::part(std::size_t begin, std::size_t count) const {
  const auto from = [&](int k) { return arrays_[k].data() + begin; };
  return {{from(0), from(1), from(2)}, {from(3), from(4), from(5)}, count};
}

TargetShortlist::TargetShortlist(const CellCamera& camera, int width, int height)
    : camera_(widened(camera)),
      width_(width + 2 * margin(camera)),
      height_(height + 2 * margin(camera)),
      view_({camera_.fx, camera_.fy}, {camera_.cx, camera_.cy}, {0, 0},
            Eigen::Array2i(width_, height_).cast<float>()),
      cover_(camera_, width_, height_) {}

void TargetShortlist::update(const TargetCloud& cloud, const SE3& T_local_camera) {
  const std::size_t before = all_.size();
  const bool changed = follow(cloud);
  if (changed) listed_.assign(all_, indices_);  // where they are now
  const SE3 moved = T_local_look_.inverse() * T_local_camera;
  const double turn = Eigen::AngleAxisd(moved.R).angle();
  // Written so that NaN looks again.
  if (looks_ == 0 || changed || !(turn < kTurn_rad && moved.t.norm() < kShift_m)) {
    look(T_local_camera);
  } else {
    for (std::size_t i = before; i < all_.size(); ++i) list(i);
  }
}

/// Takes over new points, and all of them when some moved. Returns whether any were there before.
bool TargetShortlist::follow(const TargetCloud& cloud) {
  const bool others = cloud.layout != layout_ || cloud.points.size() < all_.size();
  const bool afresh = others || cloud.moves != moves_;
  if (others) indices_.clear();
  layout_ = cloud.layout;
  moves_ = cloud.moves;
  if (afresh) all_.resize(0);
  for (std::size_t i = all_.size(); i < cloud.points.size(); ++i) {
    const TargetPoint& p = cloud.points[i];
    all_.push_back(p.point, p.alive() ? p.normal : Eigen::Vector3f::Zero());
  }
  blocks_.follow(cloud);
  if (afresh) removed_ = cloud.removed.size();
  const bool changed = afresh || removed_ != cloud.removed.size();
  for (; removed_ < cloud.removed.size(); ++removed_) {
    all_.clear_normal(static_cast<std::size_t>(cloud.removed[removed_]));
  }
  return changed;
}

void TargetShortlist::look(const SE3& T_local_camera) {
  ++looks_;
  T_local_look_ = T_local_camera;
  const SE3 inverse = T_local_camera.inverse();
  const Eigen::Matrix3f R = inverse.R.cast<float>();
  const Eigen::Vector3f t = inverse.t.cast<float>();
  cells_.resize(all_.size());
  depths_.resize(all_.size());
  draw_cover(R, t);
  const auto hidden = [&](const TargetBlocks::Sphere& s) {
    return cover_.covers(s.centre, s.radius, kBehind_m);
  };
  const auto& in_view = blocks_.in_view(view_, T_local_camera, hidden);
  nearest_.assign(nearest_.size(), std::numeric_limits<float>::infinity());
  for (const auto& range : in_view) {
    const std::size_t count = range.end - range.begin;
    const std::span cells(cells_.data() + range.begin, count);
    const std::span depths(depths_.data() + range.begin, count);
    project_to_cells(all_.part(range.begin, count), camera_, width_, height_, R, t, cells.data(),
                     depths.data());
    note_nearest(cells, depths);
  }
  spread_depths();
  list_near(in_view);
}

/// The targets of the last look cover what lies behind them, in this one, too.
void TargetShortlist::draw_cover(const Eigen::Matrix3f& R, const Eigen::Vector3f& t) {
  nearest_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                  std::numeric_limits<float>::infinity());
  project_to_cells(listed_.part(0, listed_.size()), camera_, width_, height_, R, t, cells_.data(),
                   depths_.data());
  note_nearest({cells_.data(), listed_.size()}, {depths_.data(), listed_.size()});
  cover_.draw(nearest_);
}

/// Notes the nearest depth of each cell.
void TargetShortlist::note_nearest(std::span<const int> cells, std::span<const float> depths) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] < 0) continue;
    float& nearest = nearest_[static_cast<std::size_t>(cells[i])];
    if (depths[i] < nearest) nearest = depths[i];
  }
}

/// Replaces the depth of each cell by the largest of the 3x3 cells around it; empty ones do not
/// count.
void TargetShortlist::spread_depths() {
  // Plain loops over rows, which become vector code.
  for (float& depth : nearest_) depth = std::isinf(depth) ? 0 : depth;
  spread_.resize(nearest_.size());
  for (int row = 0; row < height_; ++row) {
    const float* from = nearest_.data() + row * width_;
    float* to = spread_.data() + row * width_;
    to[0] = std::max(from[0], from[1]);
    for (int i = 1; i < width_ - 1; ++i) {
      to[i] = std::max(from[i], std::max(from[i - 1], from[i + 1]));
    }
    to[width_ - 1] = std::max(from[width_ - 1], from[width_ - 2]);
  }
  for (int row = 0; row < height_; ++row) {
    const float* from = spread_.data() + row * width_;
    const float* above = row > 0 ? from - width_ : from;
    const float* below = row + 1 < height_ ? from + width_ : from;
    float* to = nearest_.data() + row * width_;
    for (int i = 0; i < width_; ++i) to[i] = std::max(from[i], std::max(above[i], below[i]));
  }
}

/// Lists those that lie hardly behind the depths.
void TargetShortlist::list_near(const std::vector<TargetBlocks::Range>& ranges) {
  std::size_t most = 0;
  for (const auto& range : ranges) most += range.end - range.begin;
  indices_.resize(most);
  std::size_t count = 0;
  for (const auto& range : ranges) {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      // No predictor guesses which are near: no branches.
      const int cell = std::max(cells_[i], 0);
      const bool near = depths_[i] < nearest_[static_cast<std::size_t>(cell)] + kBehind_m;
      indices_[count] = static_cast<int>(i);
      count += static_cast<std::size_t>((cells_[i] >= 0) & near);
    }
  }
  indices_.resize(count);
  listed_.assign(all_, indices_);
}

void TargetShortlist::list(std::size_t i) {
  listed_.push_back(all_, i);
  indices_.push_back(static_cast<int>(i));
}

}  // namespace sgs::registration
