// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/loop_closer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "sgs/loops/drift.h"
#include "sgs/registration/view_distance.h"

namespace sgs::loops {
namespace {

constexpr std::size_t kMostPending = 64;
constexpr std::size_t kMostViews = 434;  // of places: what there is to solve grows with them

/// By how many image widths a view may be elsewhere than expected, one standard deviation.
double view_sigma(const Matrix6d& covariance, const PinholeCamera& camera, double depth_m) {
  const double shift_m = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
  const double turn = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  const double widths = camera.fx / camera.width;
  return widths * (shift_m / depth_m + turn) + 0.5 * shift_m / depth_m + 0.5 * turn;
}

bool agree(const PoseGraph& pose_graph, const graph::Edge& k, const graph::Edge& l) {
  const auto uncertain = [](const graph::Edge& e) {
    return graph::UncertainPose{e.T_from_to, graph::covariance_of(e.information)};
  };
  const auto round = uncertain(k) * pose_graph.tracked(k.to, l.to) * inverse(uncertain(l)) *
                     pose_graph.tracked(l.from, k.from);
  return closure_chi2(round) < graph::chi2_limit(6);
}

}  // namespace

LoopCloser::LoopCloser(const LoopConfig& config, const PairConfig& pair, std::uint64_t seed,
                       std::shared_ptr<history::ViewStore> views)
    : config_(config),
      verifier_(config, pair),
      odometry_check_(config),
      fern_seed_(seed),
      ferns_(seed),
      views_(std::move(views)) {}

void LoopCloser::know(const alignment::KnownView& view, const RgbdFrame& frame,
                      const history::Revision& revision,
                      const std::optional<graph::UncertainPose>& odometry) {
  constexpr double kFarFromIt_s = 10;    // lost for so long a camera may be anywhere in a house
  constexpr double kLeastDepth_m = 0.1;  // of a view that another camera hardly has
  pose_graph_.follow(revision);
  if (pose_graph_.size() == 0) {
    fern_seed_ = view.fern_seed;
    ferns_ = features::Ferns(fern_seed_);
  }
  const history::Path::Entry& place = revision.path.back();
  Node node;
  node.frame = place.frame;
  node.timestamp_s = place.timestamp_s;
  node.mean_depth_m =
      std::max(kLeastDepth_m, registration::mean_depth(frame.depth, kFarthestDepth_m));
  node.motion = view.motion;
  node.view = views_->keep(frame, revision.calibration);
  // Other questions: those of brightness and depth are answered by the view.
  node.ferns = view.fern_seed == fern_seed_ ? view.ferns : ferns_.code(frame);
  node.left = true;
  const double step_m =
      pose_graph_.size() == 0
          ? 0
          : (pose_graph_.pose(pose_graph_.size() - 1).inverse() * place.T_odom_camera).t.norm();
  constexpr double kSeen = 1e9;  // 1/m^2: what is left is the drift on the way
  pose_graph_.add(std::move(node),
                  motion_covariance(kSeen * Matrix6d::Identity(), 1, step_m, 0, config_.drift));
  if (odometry && pose_graph_.size() > 1) pose_graph_.replace_last_odometry_edge(*odometry);
  gap_s_ = kFarFromIt_s;
  is_apart_ = true;
}

void LoopCloser::know(const graph::Edge& loop) {
  pose_graph_.add_loop(loop);
  loops_solved_ = pose_graph_.loops().size();
}

// The camera has found itself by an alignment to what is known, as a loop is found: as well it
// knows where it is.
void LoopCloser::tie_to_known_place(const Matrix6d& normal_equations) {
  if (!std::exchange(is_apart_, false)) return;
  const int newest = pose_graph_.size() - 1;
  int nearest = -1;
  double least = 0;
  for (int k = 0; k < newest; ++k) {
    const double distance =
        registration::view_distance(camera_, pose_graph_.node(k).mean_depth_m,
                                    pose_graph_.pose(k).inverse() * pose_graph_.pose(newest));
    if (nearest < 0 || distance < least) std::tie(nearest, least) = std::pair(k, distance);
  }
  if (nearest < 0) return;
  // One frame tells it, against views of another day: less well than a loop that neighbours
  // confirm.
  DriftConfig drift = config_.drift;
  drift.floor_m = std::max(drift.floor_m, 0.05);
  const Matrix6d information = edge_information(
      normal_equations, pose_graph_.node(newest).mean_depth_m, config_.min_information, drift);
  know({nearest, newest, pose_graph_.pose(nearest).inverse() * pose_graph_.pose(newest),
        information, false});
}

// Loops that were measured with another depth are not believed.
void LoopCloser::take_over(const history::Revision& revision) {
  if (revision.calibration != pose_graph_.revision().calibration) {
    pending_.clear();
    odometry_check_.forget();
  }
  pose_graph_.follow(revision);
}

std::optional<PoseCorrection> LoopCloser::add(const RgbdFrame& frame, const TrackedFrame& tracked,
                                              const history::Revision& revision) {
  take_over(revision);
  const double dt = last_frame_ ? frame.timestamp_s - last_s_ : 0;
  if (!last_frame_) begin_s_ = solved_s_ = frame.timestamp_s;
  last_s_ = frame.timestamp_s;
  if (tracked.lost) {
    gap_s_ += dt;
    return std::nullopt;
  }
  if (!tracked.information) return std::nullopt;
  camera_ = frame.camera;
  if (last_frame_) {
    const history::Path& path = revision.path;
    path_m_ += (path.at(frame.index).t - path.at(*last_frame_).t).norm();
  }
  last_frame_ = frame.index;
  if (!wants_node(frame)) return std::nullopt;
  add_node(frame, tracked);
  look_for_loops();
  accept_supported();
  return is_time_to_solve() ? correction() : std::nullopt;
}

bool LoopCloser::wants_node(const RgbdFrame& frame) const {
  if (pose_graph_.size() == 0 || gap_s_ > 0) return true;
  const Node& last = pose_graph_.node(pose_graph_.size() - 1);
  const SE3 T_last_camera = pose_graph_.pose(pose_graph_.size() - 1).inverse() *
                            pose_graph_.revision().path.at(frame.index);
  return registration::view_distance(frame.camera, last.mean_depth_m, T_last_camera) >
         odometry_check_.share() * config_.view_distance;
}

void LoopCloser::add_node(const RgbdFrame& frame, const TrackedFrame& tracked) {
  Node node;
  node.frame = frame.index;
  node.timestamp_s = frame.timestamp_s;
  node.mean_depth_m = registration::mean_depth(frame.depth, kFarthestDepth_m);
  if (node.mean_depth_m <= 0) return;
  node.motion = tracked.motion;
  node.view = views_->keep(frame, pose_graph_.revision().calibration);
  node.ferns = ferns_.code(frame);
  const Matrix6d covariance =
      motion_covariance(*tracked.information, node.mean_depth_m, path_m_, gap_s_, config_.drift);
  pose_graph_.add(std::move(node), covariance);
  check_odometry();
  tie_to_known_place(*tracked.information);
  pose_graph_.note_left(camera_, config_.left_distance);
  pose_graph_.bound_views(camera_, kMostViews);
  pose_graph_.join_odometry_edges(pending_);
  path_m_ = gap_s_ = 0;
}

// Across a gap nothing was tracked that could be wrong.
void LoopCloser::check_odometry() {
  if (gap_s_ > 0) {
    odometry_check_.forget();
  } else if (const auto odometry = odometry_check_.re_estimated(pose_graph_, verifier_)) {
    pose_graph_.replace_last_odometry_edge(*odometry);
    odometry_re_estimated_ = true;
    ++counts_.re_estimated;
  }
}

// Nodes from one loop to the next between the same two stretches.
int LoopCloser::spacing() const {
  constexpr int kMostTimes = 8;
  const int share = static_cast<int>(config_.spacing_share * pose_graph_.nodes_added());
  return std::clamp(share, config_.spacing_nodes, kMostTimes * config_.spacing_nodes);
}

// Numbers of older nodes that a loop was found to a moment ago.
std::vector<int> LoopCloser::recently_tied() const {
  const auto number = [&](int node) { return pose_graph_.node(node).number; };
  const int newest = number(pose_graph_.size() - 1);
  std::vector<int> tied;
  for (const graph::Edge& e : pose_graph_.loops()) {
    if (newest - number(e.to) < spacing()) tied.push_back(number(e.from));
  }
  return tied;
}

// Older nodes that may see what the newest one sees, the most alike first.
std::vector<int> LoopCloser::candidates(const std::vector<graph::UncertainPose>& predicted) const {
  const int newest = pose_graph_.size() - 1;
  const Node& n = pose_graph_.node(newest);
  const std::vector<int> tied = recently_tied();
  const auto tied_to = [&](const Node& m) {
    return std::any_of(tied.begin(), tied.end(),
                       [&](int number) { return std::abs(m.number - number) < 2 * spacing(); });
  };
  std::vector<std::pair<double, int>> alike;
  for (int k = 0; k < newest; ++k) {
    const Node& m = pose_graph_.node(k);
    if (!m.left || !m.view || n.timestamp_s - m.timestamp_s < config_.min_gap_s) continue;
    const graph::UncertainPose& p = predicted[static_cast<std::size_t>(k)];
    const double distance = registration::view_distance(camera_, m.mean_depth_m, p.T);
    const double reach = config_.reach_sigmas * view_sigma(p.covariance, camera_, m.mean_depth_m);
    if (distance - reach > config_.revisit_distance || tied_to(m)) continue;
    alike.emplace_back(-features::Ferns::similarity(m.ferns, n.ferns), k);
  }
  std::sort(alike.begin(), alike.end());
  std::vector<int> out;
  for (const auto& likeness_and_node : alike) {
    if (static_cast<int>(out.size()) >= config_.candidates) break;
    const int k = likeness_and_node.second;
    const auto next_to = [&](int other) {
      return std::abs(pose_graph_.node(other).number - pose_graph_.node(k).number) <
             config_.spacing_nodes;
    };
    if (std::none_of(out.begin(), out.end(), next_to)) out.push_back(k);
  }
  return out;
}

void LoopCloser::look_for_loops() {
  const int newest = pose_graph_.size() - 1;
  const auto predicted = pose_graph_.relative_to(newest);
  for (const int older : candidates(predicted)) {
    ++counts_.compared;
    const graph::UncertainPose& p = predicted[static_cast<std::size_t>(older)];
    const auto loop = verifier_.verify(pose_graph_, older, newest, p.T);
    if (!loop) continue;
    ++counts_.verified;
    if (deviation_chi2(*loop, p) > config_.max_gate_chi2) {
      ++counts_.gated;
      continue;
    }
    if (pending_.size() < kMostPending) pending_.push_back(*loop);
  }
}

// Pending loops become edges once enough of them agree with each other.
void LoopCloser::accept_supported() {
  const int newest = pose_graph_.nodes_added() - 1;
  std::erase_if(pending_, [&](const graph::Edge& e) {
    return newest - pose_graph_.node(e.to).number > config_.patience_nodes;
  });
  std::vector<std::uint64_t> agrees(pending_.size(), 0);
  for (std::size_t i = 0; i < pending_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (pending_[i].to == pending_[j].to || !agree(pose_graph_, pending_[i], pending_[j]))
        continue;
      agrees[i] |= std::uint64_t{1} << j;
      agrees[j] |= std::uint64_t{1} << i;
    }
  }
  const std::vector<int> believed = graph::largest_agreement(agrees);
  if (static_cast<int>(believed.size()) < config_.support) return;
  for (const int k : believed) pose_graph_.add_loop(pending_[static_cast<std::size_t>(k)]);
  for (auto k = believed.rbegin(); k != believed.rend(); ++k) pending_.erase(pending_.begin() + *k);
  counts_.accepted += static_cast<int>(believed.size());
}

// Loops that say what is known already, within their noise, wait: each correction moves map and
// targets, and each costs what the whole graph does. A re-estimated odometry edge does not: what
// the map learns until it is corrected, it learns in the wrong place.
bool LoopCloser::is_time_to_solve() const {
  const auto& loops = pose_graph_.loops();
  if (odometry_re_estimated_) return true;
  if (loops.size() == loops_solved_) return false;
  if (last_s_ - solved_s_ >= config_.rhythm * (last_s_ - begin_s_)) return true;
  return std::any_of(loops.begin() + static_cast<std::ptrdiff_t>(loops_solved_), loops.end(),
                     [&](const graph::Edge& e) {
                       return graph::chi2(e, pose_graph_.pose(e.from), pose_graph_.pose(e.to)) >
                              graph::chi2_limit(6);
                     });
}

// Solves with new loops and re-estimated odometry edges; takes loops back where they bend the
// odometry edge too much.
std::optional<PoseCorrection> LoopCloser::correction() {
  const std::size_t fresh = pose_graph_.loops().size() - loops_solved_;
  const bool in_flight = pose_graph_.revision().loops < counts_.corrections;
  if ((fresh == 0 && !odometry_re_estimated_) || in_flight) return std::nullopt;
  const graph::GraphSolution solution = pose_graph_.solve();
  solved_s_ = last_s_;
  odometry_re_estimated_ = false;
  const bool bent =
      !solution.found ||
      std::any_of(solution.chi2.begin(), solution.chi2.begin() + pose_graph_.tracked_edges(),
                  [&](double c) { return !(c <= config_.max_odometry_chi2); });
  const bool refused = std::any_of(solution.weights.end() - static_cast<std::ptrdiff_t>(fresh),
                                   solution.weights.end(), [](double w) { return w <= 0; });
  if (bent || refused) {
    pose_graph_.remove_last_loops(fresh);
    counts_.accepted -= static_cast<int>(fresh);
    counts_.taken_back += static_cast<int>(fresh);
    return std::nullopt;
  }
  pose_graph_.thin_loops(static_cast<std::size_t>(config_.most_loops));
  loops_solved_ = pose_graph_.loops().size();
  std::vector<MovedPose> poses;
  for (int k = 0; k < pose_graph_.size(); ++k) {
    poses.push_back({pose_graph_.node(k).timestamp_s, pose_graph_.pose(k),
                     solution.T_world_node[static_cast<std::size_t>(k)]});
  }
  PoseCorrection out(std::move(poses));
  if (out.largest_translation_m() < config_.apply_m &&
      out.largest_rotation_rad() < config_.apply_deg * std::numbers::pi / 180) {
    return std::nullopt;
  }
  ++counts_.corrections;
  return out;
}

}  // namespace sgs::loops
