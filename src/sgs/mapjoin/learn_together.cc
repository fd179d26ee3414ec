// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/learn_together.h"

#include <memory>
#include <utility>
#include <vector>

#include "sgs/camera/resample.h"
#include "sgs/core/log.h"
#include "sgs/history/view_store.h"
#include "sgs/mapper/mapper.h"
#include "sgs/slam/session_config.h"

namespace sgs::mapjoin {
namespace {

// Twice as many gain 0.1 to 0.5 dB (docs/decisions/0080-learnt-after-the-last-frame.md).
constexpr int kStepsPerView = 30;

std::vector<mapper::KnownKeyframe> keyframes_of(const Part& part, history::ViewStore& views) {
  const PinholeCamera camera = part.sessions.front().camera;
  std::vector<mapper::KnownKeyframe> keyframes;
  keyframes.reserve(part.views());
  for (std::size_t i = 0; i < part.views(); ++i) {
    const alignment::KnownView view = part.view(i);
    RgbdFrame frame = resampled(view.frame, camera);
    frame.index = alignment::known_view_index(i);
    frame.timestamp_s = alignment::known_view_time_s(i);
    keyframes.push_back(
        {views.keep(frame), view.motion.lag(), part.graph.T_map_camera[i], part.T_world_camera[i]});
  }
  return keyframes;
}

}  // namespace

std::int64_t learn_together(Part& part, ThreadPool& pool) {
  const slam::SessionConfig config;
  const auto views =
      std::make_shared<history::ViewStore>(config.history, config.mapper.insertion.max_depth_m);
  mapper::Mapper mapper(config.mapper, part.sessions.front().camera, config.seed, &pool, views);
  mapper.know(part.gaussians.splats.gaussians, views_of_gaussians(part),
              keyframes_of(part, *views));
  const int steps = kStepsPerView * static_cast<int>(part.views());
  log().info("learning all Gaussians together, {} steps", steps);
  mapper.iterate(steps);
  const map::SnapshotPtr learned = mapper.snapshot();
  mapfile::MapGaussians gaussians;
  gaussians.splats.gaussians = learned->gaussians;
  for (const map::Anchor& anchor : learned->anchors) {
    gaussians.born_in.push_back(part.gaussians.born_in.at(anchor.id));
    gaussians.born_s.push_back(part.gaussians.born_s.at(anchor.id));
  }
  part.gaussians = std::move(gaussians);
  part.graph.T_map_camera = learned->T_world_keyframe;
  return mapper.iterations();
}

}  // namespace sgs::mapjoin
