// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "sgs/viewer/frame_update.h"

/// Small maps and updates for the tests of this module.
namespace sgs::viewer::testing {

inline map::Gaussian gaussian(float x) {
  map::Gaussian g{};
  g.mean[0] = x;
  for (float& s : g.log_scale) s = std::log(0.1f);
  g.rotation[0] = 2;  // not unit
  g.opacity_logit = 1;
  g.rgb[0] = 0.5f;
  return g;
}

/// Gaussians with the given ids, their x being the id.
inline std::shared_ptr<map::Snapshot> snapshot(std::uint64_t version,
                                               const std::vector<std::uint32_t>& ids) {
  auto s = std::make_shared<map::Snapshot>();
  s->version = version;
  for (const std::uint32_t id : ids) {
    s->gaussians.push_back(gaussian(static_cast<float>(id)));
    s->anchors.emplace_back();
    s->anchors.back().id = id;
  }
  return s;
}

inline FrameUpdate update(std::int64_t index, map::SnapshotPtr map = nullptr) {
  FrameUpdate u;
  u.record.index = index;
  u.record.timestamp_s = 0.1 * static_cast<double>(index);
  u.record.status = tracker::TrackingStatus::kOk;
  u.T_world_camera.t.x() = static_cast<double>(index);
  u.map = std::move(map);
  return u;
}

}  // namespace sgs::viewer::testing
