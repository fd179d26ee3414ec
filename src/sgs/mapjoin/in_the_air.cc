// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/in_the_air.h"

#include <cmath>
#include <utility>
#include <vector>

namespace sgs::mapjoin {
namespace {

constexpr float kSame_m = 0.02f, kSameShare = 0.02f;  // of the depth: noise, and how maps fit

/// What the views say of the place of a Gaussian.
struct Sight {
  bool on_surface = false;    ///< as its own map saw
  bool seen_through = false;  ///< as the other one saw
};

/// A view of one of the maps, for Gaussians that it may show.
struct Look {
  Look(const RgbdFrame& frame, const SE3& T_map_camera)
      : depth(frame.depth),
        camera(frame.camera),
        R(T_map_camera.inverse().R.cast<float>()),
        t(T_map_camera.inverse().t.cast<float>()) {}

  void take_in(const map::Gaussian& g, bool own, Sight& sight) const {
    const Eigen::Vector3f p = R * Eigen::Vector3f(g.mean[0], g.mean[1], g.mean[2]) + t;
    if (!(p.z() > kSame_m)) return;
    const double u = std::round(camera.fx * p.x() / p.z() + camera.cx);
    const double v = std::round(camera.fy * p.y() / p.z() + camera.cy);
    if (!(u >= 0 && v >= 0 && u < depth.width() && v < depth.height())) return;
    const float z = depth(static_cast<int>(u), static_cast<int>(v));
    if (!(z > 0)) return;
    const float same = kSame_m + kSameShare * z;
    if (own && std::abs(p.z() - z) <= same) sight.on_surface = true;
    if (!own && p.z() < z - 2 * same) sight.seen_through = true;
  }

  const DepthImage& depth;
  const PinholeCamera& camera;
  Eigen::Matrix3f R;
  Eigen::Vector3f t;
};

}  // namespace

std::size_t drop_in_the_air(Part& part, std::uint16_t first_session) {
  mapfile::MapGaussians& all = part.gaussians;
  const std::size_t count = all.born_in.size();
  std::vector<Sight> sights(count);
  for (std::size_t k = 0; k < part.views(); ++k) {
    const alignment::KnownView view = part.view(k);
    const Look look(view.frame, part.graph.T_map_camera[k]);
    const bool of_base = part.graph.session[k] < first_session;
    for (std::size_t i = 0; i < count; ++i) {
      const bool own = (all.born_in[i] < first_session) == of_base;
      look.take_in(all.splats.gaussians[i], own, sights[i]);
    }
  }
  mapfile::MapGaussians kept;
  for (std::size_t i = 0; i < count; ++i) {
    if (sights[i].seen_through && !sights[i].on_surface) continue;
    kept.splats.gaussians.push_back(all.splats.gaussians[i]);
    kept.born_in.push_back(all.born_in[i]);
    kept.born_s.push_back(all.born_s[i]);
  }
  all = std::move(kept);
  return count - all.born_in.size();
}

}  // namespace sgs::mapjoin
