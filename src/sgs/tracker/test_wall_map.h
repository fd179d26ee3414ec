// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/map/gaussian.h"

namespace sgs::tracker {

/// The papered wall as Gaussians: one in the middle of every tile, nearly as flat and as large.
inline map::SnapshotPtr wall_map(bool papered = true) {
  constexpr double kTile_m = 0.02;
  auto snapshot = std::make_shared<map::Snapshot>();
  snapshot->version = 1;
  for (double y = -1.4; y < 1.4; y += kTile_m) {
    for (double x = -1.6; x < 2.2; x += kTile_m) {
      map::Gaussian g{};
      g.mean[0] = static_cast<float>(x + kTile_m / 2);
      g.mean[1] = static_cast<float>(y + kTile_m / 2);
      g.mean[2] = static_cast<float>(alignment::kWallDistance_m);
      g.log_scale[0] = g.log_scale[1] = std::log(0.6f * static_cast<float>(kTile_m));
      g.log_scale[2] = std::log(0.001f);
      g.rotation[0] = 1;
      g.opacity_logit = 5;
      const double grey = papered ? alignment::wallpaper(x + kTile_m / 2, y + kTile_m / 2) : 128.0;
      for (float& c : g.rgb) c = static_cast<float>(grey / 255);
      snapshot->gaussians.push_back(g);
    }
  }
  snapshot->anchors.resize(snapshot->gaussians.size());
  return snapshot;
}

}  // namespace sgs::tracker
