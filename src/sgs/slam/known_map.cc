// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/known_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sgs/loops/agreeing_poses.h"
#include "sgs/slam/session.h"

namespace sgs::slam {
namespace {

/// The nodes that still have a view.
std::vector<const loops::Node*> nodes_with_views(const loops::PoseGraph* pose_graph) {
  std::vector<const loops::Node*> nodes;
  for (int i = 0; pose_graph != nullptr && i < pose_graph->size(); ++i) {
    if (pose_graph->node(i).view) nodes.push_back(&pose_graph->node(i));
  }
  return nodes;
}

/// What can be known of a view that is gone is where it was.
RgbdFrame seen_from(const loops::Node& node, const history::CalibrationPtr& calibration) {
  if (auto frame = node.view->frame(calibration)) return *std::move(frame);
  RgbdFrame nothing;
  nothing.index = node.frame;
  nothing.timestamp_s = node.timestamp_s;
  nothing.camera = node.view->camera();
  nothing.color = ColorImage(nothing.camera.width, nothing.camera.height);
  nothing.depth = DepthImage(nothing.camera.width, nothing.camera.height);
  return nothing;
}

}  // namespace

std::vector<Birth> births_of(const Session& session, const map::Snapshot& snapshot) {
  const auto keyframes = session.keyframes();
  const EarlierSessions& earlier = session.earlier();
  const std::size_t first = earlier.views.size();  // keyframe of this session
  std::vector<Birth> births;
  births.reserve(snapshot.anchors.size());
  for (const map::Anchor& anchor : snapshot.anchors) {
    if (anchor.id < earlier.births.size()) {
      births.push_back(earlier.births[anchor.id]);
      continue;
    }
    const std::size_t k = static_cast<std::size_t>(anchor.keyframe) - first;
    const bool known = anchor.keyframe >= 0 && k < keyframes.size();
    births.push_back({earlier.sessions,
                      known ? keyframes[k].timestamp_s : std::numeric_limits<double>::quiet_NaN()});
  }
  return births;
}

std::size_t known_views(const Session& session) {
  return nodes_with_views(session.pose_graph()).size();
}

// The last revision may have come after the nodes were last told.
alignment::KnownView known_view(const Session& session, const Trajectory& path,
                                std::size_t number) {
  const auto nodes = nodes_with_views(session.pose_graph());
  SGS_CHECK(number < nodes.size(), "no such view");
  const loops::Node& node = *nodes[number];
  alignment::KnownView view;
  const auto* earlier = session.earlier().view(node.frame);
  view.timestamp_s = earlier != nullptr ? earlier->time_s : node.timestamp_s;
  view.T_world_camera =
      path.at(node.timestamp_s, 0.0).value_or(session.revision().path.at(node.frame));
  view.motion = node.motion;
  view.frame = seen_from(node, session.revision().calibration);
  view.ferns = node.ferns;
  view.fern_seed = session.fern_seed();
  if (const auto change = history::depth_change(session.pose_graph()->revision().calibration,
                                                session.revision().calibration)) {
    view.motion.recalibrate(change->delay_s());
  }
  return view;
}

std::vector<SE3> agreeing_poses(const Session& session, const Trajectory& path, ThreadPool& pool) {
  const auto view = [&](std::size_t number) { return known_view(session, path, number); };
  return loops::agreeing_poses({known_views(session), view}, session.config().loops,
                               tracker::aligner_config(session.config().tracker), pool);
}

std::vector<SE3> places_in_map(const Session& session) {
  const PoseCorrection to_map = session.odom_to_map();
  std::vector<SE3> out;
  for (const loops::Node* node : nodes_with_views(session.pose_graph())) {
    const SE3& T = session.revision().path.at(node->frame);
    out.push_back(to_map.empty() ? T : to_map.corrected(T, node->timestamp_s));
  }
  return out;
}

std::vector<std::uint16_t> sessions_of_views(const Session& session) {
  std::vector<std::uint16_t> out;
  for (const loops::Node* node : nodes_with_views(session.pose_graph())) {
    const auto* earlier = session.earlier().view(node->frame);
    out.push_back(earlier != nullptr ? earlier->session : session.earlier().sessions);
  }
  return out;
}

// Poses are where all measurements together want them: edges that say so, as surely, hold them
// there as the measurements do. What was forgotten on the way (views, loops) does not pull at them
// later.
std::vector<graph::Edge> edges_of_views(const Session& session, const std::vector<SE3>& poses) {
  std::vector<graph::Edge> out;
  const loops::PoseGraph* pose_graph = session.pose_graph();
  if (pose_graph == nullptr) return out;
  std::vector<int> number(static_cast<std::size_t>(pose_graph->size()), -1);
  const auto add = [&](int from, int to, const Matrix6d& information, bool doubtful) {
    const int a = number[static_cast<std::size_t>(from)], b = number[static_cast<std::size_t>(to)];
    const SE3 T = poses[static_cast<std::size_t>(a)].inverse() * poses[static_cast<std::size_t>(b)];
    out.push_back({a, b, T, information, doubtful});
  };
  int views = 0;
  for (int k = 0, last = -1; k < pose_graph->size(); ++k) {
    if (!pose_graph->node(k).view) continue;
    number[static_cast<std::size_t>(k)] = views++;
    if (last >= 0) add(last, k, pose_graph->tracked(last, k).covariance.inverse(), false);
    last = k;
  }
  for (const graph::Edge& loop : pose_graph->loops()) {
    const bool kept = number[static_cast<std::size_t>(loop.from)] >= 0 &&
                      number[static_cast<std::size_t>(loop.to)] >= 0;
    if (kept) add(loop.from, loop.to, loop.information, loop.doubtful);
  }
  return out;
}

std::vector<std::int32_t> views_of_gaussians(const KnownMap& map,
                                             const std::vector<double>& view_times_s) {
  // Views of a session in order of time; numbers of those of each session follow each other.
  std::vector<std::vector<std::pair<double, std::int32_t>>> views(map.sessions);
  for (std::size_t i = 0; i < view_times_s.size(); ++i) {
    views[map.session_of[i]].emplace_back(view_times_s[i], static_cast<std::int32_t>(i));
  }
  for (auto& of_session : views) std::sort(of_session.begin(), of_session.end());
  std::vector<std::int32_t> out;
  out.reserve(map.births.size());
  for (const Birth& birth : map.births) {
    const bool known = birth.session < views.size() && !views[birth.session].empty() &&
                       std::isfinite(birth.time_s);
    if (!known) {
      out.push_back(0);
      continue;
    }
    const auto& of_session = views[birth.session];
    const auto after = std::lower_bound(of_session.begin(), of_session.end(),
                                        std::pair(birth.time_s, std::int32_t{0}));
    if (after == of_session.begin()) {
      out.push_back(after->second);
      continue;
    }
    const auto before = after - 1;
    const bool later =
        after != of_session.end() && after->first - birth.time_s < birth.time_s - before->first;
    out.push_back(later ? after->second : before->second);
  }
  return out;
}

}  // namespace sgs::slam
