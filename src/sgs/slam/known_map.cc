// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/known_map.h"

#include <limits>

#include "sgs/loops/agreeing_poses.h"
#include "sgs/slam/session.h"

namespace sgs::slam {
namespace {

/// The nodes that still have a view.
std::vector<const loops::Node*> nodes_with_views(const loops::Skeleton* skeleton) {
  std::vector<const loops::Node*> nodes;
  for (int i = 0; skeleton != nullptr && i < skeleton->size(); ++i) {
    if (!skeleton->node(i).view.empty()) nodes.push_back(&skeleton->node(i));
  }
  return nodes;
}

}  // namespace

std::vector<double> births_of(const Session& session, const map::Snapshot& snapshot) {
  const std::vector<KeyframePose>& keyframes = session.keyframes();
  std::vector<double> births;
  births.reserve(snapshot.anchors.size());
  for (const map::Anchor& anchor : snapshot.anchors) {
    const auto k = static_cast<std::size_t>(anchor.keyframe);
    const bool known = anchor.keyframe >= 0 && k < keyframes.size();
    births.push_back(known ? keyframes[k].timestamp_s : std::numeric_limits<double>::quiet_NaN());
  }
  return births;
}

std::size_t known_views(const Session& session) {
  return nodes_with_views(session.skeleton()).size();
}

// The last revision may have come after the nodes were last told.
tracker::KnownView known_view(const Session& session, const Trajectory& path, std::size_t number) {
  const auto nodes = nodes_with_views(session.skeleton());
  SGS_CHECK(number < nodes.size(), "no such view");
  const loops::Node& node = *nodes[number];
  tracker::KnownView view;
  view.timestamp_s = node.timestamp_s;
  view.T_world_camera =
      path.at(node.timestamp_s, 0.0).value_or(session.revision().path.at(node.frame));
  view.motion = node.motion;
  view.view = node.view;
  view.ferns = node.ferns;
  view.fern_seed = session.config().seed;
  if (const auto change = history::depth_change(session.skeleton()->revision().calibration,
                                                session.revision().calibration)) {
    view.view.change_depth(*change);
    view.motion.recalibrate(change->delay_s());
  }
  return view;
}

std::vector<SE3> agreeing_poses(const Session& session, const Trajectory& path, ThreadPool& pool) {
  const auto view = [&](std::size_t number) { return known_view(session, path, number); };
  return loops::agreeing_poses({known_views(session), view}, session.config().loops,
                               session.config().tracker, pool);
}

}  // namespace sgs::slam
