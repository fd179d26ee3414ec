// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_lag.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sgs {
namespace {

/// Of every 16th pixel in both directions; 0 where none is measured.
float median_depth(const DepthImage& depth) {
  constexpr int kStep = 16;
  std::vector<float> measured;
  for (int v = 0; v < depth.height(); v += kStep) {
    for (int u = 0; u < depth.width(); u += kStep) {
      if (depth(u, v) > 0) measured.push_back(depth(u, v));
    }
  }
  if (measured.empty()) return 0;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle;
}

}  // namespace

DepthImage depth_with_colour(const DepthImage& depth, const PinholeCamera& camera,
                             const Vector6d& lag) {
  const float usual = median_depth(depth);
  if (lag.isZero(0) || usual == 0) return depth;
  constexpr int kSteps = 2;  // the flow changes little from pixel to pixel
  const auto f = [](double x) { return static_cast<float>(x); };
  const float fx = f(camera.fx), fy = f(camera.fy), cx = f(camera.cx), cy = f(camera.cy);
  const Eigen::Vector3f w = lag.head<3>().cast<float>(), t = lag.tail<3>().cast<float>();
  DepthImage out(depth.width(), depth.height());
  for (int v = 0; v < depth.height(); ++v) {
    const float y = (f(v) - cy) / fy;
    for (int u = 0; u < depth.width(); ++u) {
      const float x = (f(u) - cx) / fx;
      float z = depth(u, v) > 0 ? depth(u, v) : usual;
      bool found = false;
      for (int step = 0; step < kSteps; ++step) {
        // Where the camera of the depth image saw the point at depth z on this pixel's ray.
        const float px = x - (w.y() - w.z() * y + t.x() / z);
        const float py = y - (w.z() * x - w.x() + t.y() / z);
        const float pz = 1 - (w.x() * y - w.y() * x + t.z() / z);
        const int from_u = static_cast<int>(std::floor(fx * px / pz + cx + 0.5f));
        const int from_v = static_cast<int>(std::floor(fy * py / pz + cy + 0.5f));
        found = depth.contains(from_u, from_v) && depth(from_u, from_v) > 0;
        if (!found) break;
        z = depth(from_u, from_v) / pz;
      }
      if (found) out(u, v) = z;
    }
  }
  return out;
}

std::shared_ptr<const RgbdFrame> frame_of_one_time(const std::shared_ptr<const RgbdFrame>& frame,
                                                   const Vector6d& lag) {
  if (lag.isZero(0)) return frame;
  auto out = copy_to_change(frame);
  out->depth = depth_with_colour(frame->depth, frame->camera, lag);
  out->depth_delay_s = 0;
  return out;
}

}  // namespace sgs
