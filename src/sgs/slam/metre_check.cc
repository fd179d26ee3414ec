// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/metre_check.h"

#include <cmath>
#include <utility>

namespace sgs::slam {
namespace {

constexpr int kFrames = 30, kStep_px = 16, kEnough = 100;
constexpr double kNear_m = 0.3, kFar_m = 5;  // beyond, noise is what differs
constexpr double kSameSurface = 0.15;        // share of the depth, before the frame is fitted
constexpr double kFits = 0.03;               // and after
constexpr double kLeastSpread_m = 0.15;      // of depths, one standard deviation
constexpr double kLeastCosine = 0.75;        // between viewing directions

struct Pair {
  double x, y;
};

/// Where `points` of the view are seen in the frame, and what is measured there.
std::vector<Pair> pairs_of(const std::vector<Eigen::Vector3d>& points, const SE3& T_camera_view,
                           const RgbdFrame& frame) {
  std::vector<Pair> pairs;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d q = T_camera_view * point;
    if (!(q.z() > kNear_m && q.z() < kFar_m)) continue;
    const double u = frame.camera.fx * q.x() / q.z() + frame.camera.cx;
    const double v = frame.camera.fy * q.y() / q.z() + frame.camera.cy;
    if (!(u > -0.5 && v > -0.5 && u < frame.camera.width - 0.5 && v < frame.camera.height - 0.5)) {
      continue;
    }
    const double z =
        frame.depth(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
    if (z > 0 && std::abs(z - q.z()) < kSameSurface * q.z()) pairs.push_back({q.z(), z});
  }
  return pairs;
}

struct Line {
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  int count = 0;

  explicit Line(const std::vector<Pair>& pairs) : count(static_cast<int>(pairs.size())) {
    for (const Pair& p : pairs) {
      mean_x += p.x / count;
      mean_y += p.y / count;
    }
    for (const Pair& p : pairs) {
      xx += (p.x - mean_x) * (p.x - mean_x);
      xy += (p.x - mean_x) * (p.y - mean_y);
    }
  }
  double at(double x) const { return mean_y + (xx > 0 ? xy / xx : 1) * (x - mean_x); }
};

}  // namespace

void MetreCheck::know(std::int64_t index, const RgbdFrame& view) {
  View& known = views_.emplace_back(View{index, {}});
  for (int v = kStep_px / 2; v < view.camera.height; v += kStep_px) {
    for (int u = kStep_px / 2; u < view.camera.width; u += kStep_px) {
      const double z = view.depth(u, v);
      if (z > kNear_m && z < kFar_m) known.points.push_back(view.camera.back_project(u, v, z));
    }
  }
}

bool MetreCheck::add(const RgbdFrame& frame, const SE3& T_world_camera, const history::Path& path) {
  if (views_.empty() || frames_ >= kFrames) return false;
  std::vector<Pair> most;
  for (const View& view : views_) {
    const SE3 T_camera_view = T_world_camera.inverse() * path.at(view.index);
    if (T_camera_view.R(2, 2) < kLeastCosine) continue;
    std::vector<Pair> pairs = pairs_of(view.points, T_camera_view, frame);
    if (pairs.size() > most.size()) most = std::move(pairs);
  }
  if (most.size() < kEnough) return false;
  const Line first(most);
  std::erase_if(most, [&](const Pair& p) { return std::abs(p.y - first.at(p.x)) > kFits * p.x; });
  if (most.size() < kEnough) return false;
  const Line line(most);
  sums_.xx += line.xx;
  sums_.xy += line.xy;
  sums_.count += line.count;
  return ++frames_ == kFrames;
}

std::optional<double> MetreCheck::ratio() const {
  if (frames_ < kFrames || sums_.xx < kLeastSpread_m * kLeastSpread_m * sums_.count) {
    return std::nullopt;
  }
  return sums_.xy / sums_.xx;
}

}  // namespace sgs::slam
