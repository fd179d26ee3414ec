// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/robot/live_grid.h"

#include <algorithm>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/occupancy/depth_samples.h"

namespace sgs::robot {
namespace {

/// As far as views are alike.
bool near(const SE3& a, const SE3& b, double most_m, double most_rad) {
  return (a.t - b.t).norm() < most_m && (a.inverse() * b).angle() < most_rad;
}

}  // namespace

LiveGrid::LiveGrid(const GridOptions& options, const SE3& T_upright_map)
    : options_(options),
      T_upright_map_(T_upright_map),
      counts_{occupancy::OccupancyVolume(options.volume), {}} {}

void LiveGrid::see(const RgbdFrame& frame, const history::Path& path) {
  constexpr double kMoved_m = 0.1, kTurned = 0.1;  // radians
  const SE3& pose = path.at(frame.index);
  if (!views_.empty()) {
    const auto* last = path.find(views_.back().frame);
    if (last != nullptr && near(last->T_odom_camera, pose, kMoved_m, kTurned)) return;
  }
  const auto& volume = options_.volume;
  const int stride = occupancy::stride_for(frame.camera, volume.voxel_m, volume.range_m);
  View view{frame.index, pose, {}};
  for (const auto& sample : occupancy::sample_depth(frame.camera, frame.depth, stride)) {
    view.samples.push_back({sample.point.cast<float>(), sample.normal.cast<float>(),
                            static_cast<float>(sample.area_m2)});
  }
  count(view, pose, counts_);
  views_.push_back(std::move(view));
  if (views_.size() <= options_.most_views) return;
  views_.pop_front();
  if (recount_ && recount_->next > 0) --recount_->next;
}

void LiveGrid::count(const View& view, const SE3& T_map_camera, Counts& counts) {
  std::vector<occupancy::DepthSample> samples;
  samples.reserve(view.samples.size());
  for (const Sample& sample : view.samples) {
    samples.push_back({sample.point.cast<double>(), sample.normal.cast<double>(),
                       static_cast<double>(sample.area_m2)});
  }
  const SE3 T = T_upright_map_ * T_map_camera;
  if (!counts.volume.add(samples, T) && !std::exchange(full_, true)) {
    log().warn("the grid grows no further: more voxels of {} m than fit memory",
               options_.volume.voxel_m);
  }
  counts.floor.add(samples, T, options_.volume.range_m);
}

bool LiveGrid::has_moved(const history::Path& path) const {
  const double most_m = options_.volume.voxel_m;
  const double most_rad = most_m / options_.volume.range_m;
  for (const View& view : views_) {
    const auto* now = path.find(view.frame);
    if (now != nullptr && !near(now->T_odom_camera, view.counted_at, most_m, most_rad)) return true;
  }
  return false;
}

void LiveGrid::recount(const history::Path& path, std::size_t most) {
  if (!recount_ && has_moved(path))
    recount_ = Recount{{occupancy::OccupancyVolume(options_.volume), {}}, 0};
  for (; recount_ && most > 0 && recount_->next < views_.size(); --most) {
    View& view = views_[recount_->next++];
    const auto* now = path.find(view.frame);
    if (now == nullptr) continue;
    view.counted_at = now->T_odom_camera;
    count(view, view.counted_at, recount_->counts);
  }
  if (!recount_ || recount_->next < views_.size()) return;
  counts_ = std::move(recount_->counts);
  recount_.reset();
}

std::optional<occupancy::OccupancyGrid> LiveGrid::grid(const history::Path& path) {
  recount(path, options_.recounted_at_once);
  return counted();
}

std::optional<occupancy::OccupancyGrid> LiveGrid::whole_grid(const history::Path& path) {
  recount(path, views_.size());
  recount(path, views_.size());  // what a recount that was under way had taken from an older path
  return counted();
}

std::optional<occupancy::OccupancyGrid> LiveGrid::counted() {
  // Walls and tables that are seen later may outweigh it, but it is still there.
  if (const auto now_m = counts_.floor.height_m()) floor_m_ = now_m;
  if (!floor_m_) return {};
  auto grid = occupancy::make_grid(counts_.volume, *floor_m_, options_.band);
  return grid ? std::optional(std::move(*grid)) : std::nullopt;
}

}  // namespace sgs::robot
