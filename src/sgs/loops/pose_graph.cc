// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/pose_graph.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "sgs/core/error.h"
#include "sgs/registration/view_distance.h"

namespace sgs::loops {
void PoseGraph::add(Node node, const Matrix6d& motion_covariance) {
  if (!nodes_.empty()) {
    const SE3 T = pose(size() - 1).inverse() * revision_.path.at(node.frame);
    motions_.push_back({T, motion_covariance, motion_covariance.inverse()});
  }
  node.number = added_++;
  nodes_.push_back(std::move(node));
}

void PoseGraph::replace_last_odometry_edge(const graph::UncertainPose& odometry) {
  motions_.back() = {odometry.T, odometry.covariance, odometry.covariance.inverse()};
}

void PoseGraph::note_left(const PinholeCamera& camera, double left_distance) {
  const SE3& newest = pose(size() - 1);
  for (Node& n : nodes_) {
    n.left = n.left || registration::view_distance(camera, n.mean_depth_m,
                                                   revision_.path.at(n.frame).inverse() * newest) >
                           left_distance;
  }
}

std::optional<RgbdFrame> PoseGraph::seen(int index) const {
  const auto& view = node(index).view;
  return view ? view->frame(revision_.calibration) : std::nullopt;
}

void PoseGraph::bound_views(const PinholeCamera& camera, std::size_t most) {
  std::vector<int> kept;
  for (int k = 0; k < size(); ++k) {
    if (node(k).view) kept.push_back(k);
  }
  if (kept.size() <= most) return;
  const auto one_way = [&](int a, int b) {
    return registration::view_distance(camera, node(a).mean_depth_m, pose(a).inverse() * pose(b));
  };
  struct Likeness {
    double distance;
    int newer, older;
  };
  std::vector<Likeness> pairs;
  for (std::size_t b = 0; b < kept.size(); ++b) {
    for (std::size_t a = 0; a < b && node(kept[b]).left; ++a) {
      const double distance = std::min(one_way(kept[a], kept[b]), one_way(kept[b], kept[a]));
      pairs.push_back({distance, kept[b], kept[a]});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Likeness& x, const Likeness& y) {
    return std::tie(x.distance, y.newer, y.older) < std::tie(y.distance, x.newer, x.older);
  });
  std::size_t left = kept.size();
  for (const Likeness& pair : pairs) {
    if (left <= most - most / 8) break;
    history::StoredViewPtr& view = nodes_[static_cast<std::size_t>(pair.newer)].view;
    if (!view || !node(pair.older).view) continue;
    view.reset();
    --left;
  }
}

void PoseGraph::join_odometry_edges(std::vector<graph::Edge>& others) {
  std::vector<bool> needed(nodes_.size(), false);
  needed.front() = needed.back() = true;
  for (const auto* edges : {&loops_, &others}) {
    for (const graph::Edge& e : *edges) {
      needed[static_cast<std::size_t>(e.from)] = needed[static_cast<std::size_t>(e.to)] = true;
    }
  }
  std::vector<int> new_index(nodes_.size(), -1);
  std::size_t kept = 0;
  Motion odometry;  // from the last kept node
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    if (k > 0) {
      const Motion& m = motions_[k - 1];
      odometry = odometry.covariance.isZero(0) ? m : joined(odometry, m);
    }
    if (!needed[k] && !nodes_[k].view) continue;
    new_index[k] = static_cast<int>(kept);
    if (kept > 0) motions_[kept - 1] = odometry;
    if (kept != k) nodes_[kept] = std::move(nodes_[k]);
    odometry = Motion();
    ++kept;
  }
  nodes_.resize(kept);
  motions_.resize(kept - 1);
  for (auto* edges : {&loops_, &others}) {
    for (graph::Edge& e : *edges) {
      e.from = new_index[static_cast<std::size_t>(e.from)];
      e.to = new_index[static_cast<std::size_t>(e.to)];
    }
  }
}

PoseGraph::Motion PoseGraph::joined(const Motion& first, const Motion& then) {
  const auto both = graph::UncertainPose{first.T_from_to, first.covariance} *
                    graph::UncertainPose{then.T_from_to, then.covariance};
  return {both.T, both.covariance, both.covariance.inverse()};
}

void PoseGraph::add_loop(const graph::Edge& loop) { loops_.push_back(loop); }

void PoseGraph::remove_last_loops(std::size_t count) { loops_.resize(loops_.size() - count); }

void PoseGraph::thin_loops(std::size_t most) {
  if (loops_.size() <= most) return;
  const std::size_t old = loops_.size() - loops_.size() / 4;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    if (i >= old || i % 2 == 0) loops_[kept++] = loops_[i];
  }
  loops_.resize(kept);
}

graph::UncertainPose PoseGraph::tracked(int from, int to) const {
  if (from > to) return inverse(tracked(to, from));
  graph::UncertainPose out;
  for (int k = from; k < to; ++k) {
    const Motion& m = motions_[static_cast<std::size_t>(k)];
    out = out * graph::UncertainPose{m.T_from_to, m.covariance};
  }
  return out;
}

// Dijkstra over the sum of squared standard deviations of position, turns counted at an arm's
// length; covariances are carried to the end node's camera.
std::vector<graph::UncertainPose> PoseGraph::relative_to(int to) const {
  struct Step {
    int node;
    Matrix6d covariance;  // in world coordinates
    double cost;
  };
  std::vector<std::vector<Step>> steps(nodes_.size());
  const auto join = [&](int a, int b, const Matrix6d& at_b) {
    const Matrix6d world = graph::carried(at_b, pose(b));
    const double cost = at_b.trace();
    steps[static_cast<std::size_t>(a)].push_back({b, world, cost});
    steps[static_cast<std::size_t>(b)].push_back({a, world, cost});
  };
  for (int k = 0; k + 1 < size(); ++k) {
    join(k, k + 1, motions_[static_cast<std::size_t>(k)].covariance);
  }
  for (const graph::Edge& loop : loops_) {
    join(loop.from, loop.to, graph::covariance_of(loop.information));
  }
  std::vector<double> best(nodes_.size(), 1e300);
  std::vector<Matrix6d> covariance(nodes_.size(), Matrix6d::Zero());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  best[static_cast<std::size_t>(to)] = 0;
  queue.emplace(0, to);
  while (!queue.empty()) {
    const auto [cost, at] = queue.top();
    queue.pop();
    if (cost > best[static_cast<std::size_t>(at)]) continue;
    for (const Step& s : steps[static_cast<std::size_t>(at)]) {
      const auto next = static_cast<std::size_t>(s.node);
      if (cost + s.cost >= best[next]) continue;
      best[next] = cost + s.cost;
      covariance[next] = covariance[static_cast<std::size_t>(at)] + s.covariance;
      queue.emplace(best[next], s.node);
    }
  }
  const SE3 T_to_world = pose(to).inverse();
  std::vector<graph::UncertainPose> out;
  for (int k = 0; k < size(); ++k) {
    out.push_back({pose(k).inverse() * pose(to),
                   graph::carried(covariance[static_cast<std::size_t>(k)], T_to_world)});
  }
  return out;
}

std::vector<graph::Edge> PoseGraph::edges() const {
  std::vector<graph::Edge> out;
  for (int k = 0; k + 1 < size(); ++k) {
    const Motion& m = motions_[static_cast<std::size_t>(k)];
    out.push_back({k, k + 1, m.T_from_to, m.information, false});
  }
  out.insert(out.end(), loops_.begin(), loops_.end());
  return out;
}

std::vector<SE3> PoseGraph::poses() const {
  std::vector<SE3> out;
  out.reserve(nodes_.size());
  for (int k = 0; k < size(); ++k) out.push_back(pose(k));
  return out;
}

graph::GraphSolution PoseGraph::solve() const { return graph::optimise(poses(), edges()); }

void PoseGraph::follow(const history::Revision& revision) {
  const auto change = history::depth_change(revision_.calibration, revision.calibration);
  const bool tracked_anew = revision.second_looks != revision_.second_looks;
  const std::vector<SE3> T_before = change || tracked_anew ? poses() : std::vector<SE3>();
  revision_ = revision;
  if (change) {
    for (Node& n : nodes_) n.motion.recalibrate(change->delay_s());
  }
  if (!change && !tracked_anew) return;
  const std::vector<SE3> T_now = poses();
  const auto measured_anew = [&](const SE3& T_from_to, int from, int to) {
    const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
    const SE3 deviation = (T_before[a].inverse() * T_before[b]).inverse() * T_from_to;
    return T_now[a].inverse() * T_now[b] * deviation;
  };
  for (int k = 0; k + 1 < size(); ++k) {
    SE3& T = motions_[static_cast<std::size_t>(k)].T_from_to;
    T = measured_anew(T, k, k + 1);
  }
  if (!change) return;
  for (graph::Edge& loop : loops_) {
    loop.T_from_to = measured_anew(loop.T_from_to, loop.from, loop.to);
  }
}

}  // namespace sgs::loops
