// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/features/ferns.h"
#include "sgs/mapjoin/part.h"

namespace sgs::mapjoin {

/// The map of a camera that went along the papered wall from `begin_m` on, in steps of 15 cm, in a
/// world of its own: `T_own_wall`. Each view has brought a Gaussian on the wall, in its middle.
inline Part walk_along_wall(const std::string& name, double begin_m, int views,
                            const SE3& T_own_wall) {
  Part part;
  part.sessions = {{name, "1", alignment::kWallCamera, 0, static_cast<double>(views), views, ""}};
  std::vector<alignment::KnownView> seen;
  const features::Ferns ferns(0);
  for (int i = 0; i < views; ++i) {
    const double side = i % 2 == 0 ? 0.02 : -0.02;
    const SE3 T(so3_exp({0.02 + side, -0.01, side}), {begin_m + 0.15 * i, side, side});
    alignment::KnownView view;
    view.timestamp_s = i;
    view.T_world_camera = (T_own_wall * T).normalized();
    view.frame = alignment::see_wall(T, i);
    view.ferns = ferns.code(view.frame);
    part.times_s.push_back(i);
    part.T_world_camera.push_back(view.T_world_camera);
    seen.push_back(std::move(view));
    map::Gaussian g{};
    const Eigen::Vector3d mean =
        T_own_wall * Eigen::Vector3d(begin_m + 0.15 * i, 0, alignment::kWallDistance_m);
    for (int k = 0; k < 3; ++k) {
      g.mean[k] = static_cast<float>(mean[k]);
      g.log_scale[k] = k == 2 ? -7.0f : -4.0f;
    }
    const Eigen::Quaterniond q = T_own_wall.quaternion();
    g.rotation[0] = static_cast<float>(q.w());
    g.rotation[1] = static_cast<float>(q.x());
    g.rotation[2] = static_cast<float>(q.y());
    g.rotation[3] = static_cast<float>(q.z());
    part.gaussians.splats.gaussians.push_back(g);
    part.gaussians.born_in.push_back(0);
    part.gaussians.born_s.push_back(i);
  }
  part.graph.session.assign(seen.size(), 0);
  part.graph.T_map_camera = part.T_world_camera;
  part.view = [seen = std::move(seen)](std::size_t number) { return seen[number]; };
  return part;
}

/// A world that has nothing to do with the other.
inline SE3 another_world() { return {so3_exp({0.4, -1.1, 2.0}), {3, -2, 5}}; }

}  // namespace sgs::mapjoin
