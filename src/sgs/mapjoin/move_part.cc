// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/move_part.h"

#include <algorithm>
#include <utility>

#include "sgs/map/gaussian_store.h"
#include "sgs/mapper/known_anchor.h"
#include "sgs/mapper/merge_layers.h"
#include "sgs/mapper/move_map.h"

namespace sgs::mapjoin {

std::size_t move_part(Part& part, std::vector<SE3> T_world_camera) {
  std::vector<SE3> moves;
  for (std::size_t i = 0; i < part.views(); ++i) {
    moves.push_back((T_world_camera[i] * part.T_world_camera[i].inverse()).normalized());
  }
  const std::vector<std::int32_t> view_of = views_of_gaussians(part);
  map::GaussianStore store;
  const auto& gaussians = part.gaussians.splats.gaussians;
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    const map::Gaussian& g = gaussians[i];
    const SE3& T = part.graph.T_map_camera[static_cast<std::size_t>(view_of[i])];
    store.append(g, mapper::known_anchor(g, view_of[i], T),
                 *std::max_element(g.log_scale, g.log_scale + 3));
  }
  mapper::move_gaussians(moves, store);
  map::GaussianSet removed;
  const std::size_t merged = mapper::merge_layers(moves, {}, store, removed);
  mapfile::MapGaussians kept;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (merged > 0 && removed.contains(i)) continue;
    kept.splats.gaussians.push_back(store.average[i]);
    kept.born_in.push_back(part.gaussians.born_in[i]);
    kept.born_s.push_back(part.gaussians.born_s[i]);
  }
  part.gaussians = std::move(kept);
  for (std::size_t i = 0; i < part.views(); ++i) {
    SE3& T = part.graph.T_map_camera[i];
    T = (moves[i] * T).normalized();
  }
  place_views(part, std::move(T_world_camera));
  return merged;
}

}  // namespace sgs::mapjoin
