// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/known_map.h"

#include <limits>

#include "sgs/slam/session.h"

namespace sgs::slam {
namespace {

/// The nodes that still have a view.
std::vector<const loops::Node*> nodes_with_views(const loops::Skeleton* skeleton) {
  std::vector<const loops::Node*> nodes;
  for (int i = 0; skeleton != nullptr && i < skeleton->size(); ++i) {
    if (skeleton->node(i).view) nodes.push_back(&skeleton->node(i));
  }
  return nodes;
}

/// What can be known of a view that is gone is where it was.
CompactView seen_from(const loops::Node& node, const history::CalibrationPtr& calibration) {
  if (const auto frame = node.view->frame(calibration)) return CompactView(*frame);
  RgbdFrame nothing;
  nothing.index = node.frame;
  nothing.timestamp_s = node.timestamp_s;
  nothing.camera = node.view->camera();
  nothing.color = ColorImage(nothing.camera.width, nothing.camera.height);
  nothing.depth = DepthImage(nothing.camera.width, nothing.camera.height);
  return CompactView(nothing);
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
  view.view = seen_from(node, session.revision().calibration);
  view.ferns = node.ferns;
  view.fern_seed = session.config().seed;
  if (const auto change = history::depth_change(session.skeleton()->revision().calibration,
                                                session.revision().calibration)) {
    view.motion.recalibrate(change->delay_s());
  }
  return view;
}

}  // namespace sgs::slam
