// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/loop_verifier.h"

#include <Eigen/Eigenvalues>
#include <numbers>
#include <utility>

#include "sgs/features/visual_map.h"
#include "sgs/loops/pair_aligner.h"
#include "sgs/registration/view_distance.h"

namespace sgs::loops {

std::optional<LoopVerifier::Sight> LoopVerifier::sight(const PoseGraph& pose_graph, int node) {
  auto frame = pose_graph.seen(node);
  if (!frame) return std::nullopt;
  return Sight{&pose_graph.node(node), std::move(*frame)};
}

std::optional<LoopVerifier::Found> LoopVerifier::align(const Sight& older, const Sight& newer,
                                                       const SE3& T_start) const {
  PairAligner aligner(pair_.aligner, older.frame, older.node->motion);
  const auto a = aligner.align(newer.frame, newer.node->motion, T_start);
  if (!a || (a->used > 0 && a->used < config_.min_used)) return std::nullopt;
  const auto information = information_of(*a, newer.node->mean_depth_m, config_);
  if (!information || graph::rank(*information) < config_.min_rank) return std::nullopt;
  return Found{a->T_reference_camera, *information};
}

std::optional<LoopVerifier::Found> LoopVerifier::measure(const PoseGraph& pose_graph, int older,
                                                         int newer, const SE3& T_start) const {
  const auto from = sight(pose_graph, older), to = sight(pose_graph, newer);
  if (!from || !to) return std::nullopt;
  return align(*from, *to, T_start);
}

std::optional<SE3> LoopVerifier::match_features(const RgbdFrame& older,
                                                const RgbdFrame& newer) const {
  features::OrbExtractor extractor(pair_.orb);
  features::VisualMap map(pair_.visual_pose);
  map.insert(extractor.extract(older), SE3{});
  const auto found = map.relocalise(extractor.extract(newer));
  if (found.verdict != features::Verdict::kOk) return std::nullopt;
  return found.T_world_camera;
}

// Only along what the alignment has seen.
bool LoopVerifier::agree(const Found& found, const SE3& other) const {
  const Vector6d e = (found.T_older_newer.inverse() * other).log();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(found.information);
  Vector6d seen = Vector6d::Zero();
  for (int k = 0; k < 6; ++k) {
    const Vector6d axis = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()[k] > 1e-9 * eigen.eigenvalues()[5]) seen += axis.dot(e) * axis;
  }
  return seen.head<3>().norm() <= config_.agree_deg * std::numbers::pi / 180 &&
         seen.tail<3>().norm() <= config_.agree_m;
}

std::optional<graph::Edge> LoopVerifier::verify(const PoseGraph& pose_graph, int older, int newer,
                                                const SE3& T_older_newer) const {
  const auto from = sight(pose_graph, older), to = sight(pose_graph, newer);
  if (!from || !to) return std::nullopt;
  auto found = align(*from, *to, T_older_newer);
  if (!found) {
    const auto start = match_features(from->frame, to->frame);
    if (start) found = align(*from, *to, *start);
  }
  if (!found) return std::nullopt;
  // From afar, what a distorting camera sees does not fit: it is off by centimetres.
  const PinholeCamera& camera = from->frame.camera;
  if (registration::view_distance(camera, from->node->mean_depth_m, found->T_older_newer) >
      config_.revisit_distance) {
    return std::nullopt;
  }
  constexpr double kFarthestNeighbour = 0.7;  // a view that hardly overlaps says nothing
  int confirmed = 0;
  for (const int step : {-1, 1}) {
    int neighbour = older + step;
    const auto exists = [&] { return neighbour >= 0 && neighbour < newer - 1; };
    while (exists() && !pose_graph.node(neighbour).view) neighbour += step;
    if (!exists()) continue;
    const SE3 T_older_neighbour = pose_graph.tracked(older, neighbour).T;
    const SE3 expected = T_older_neighbour.inverse() * found->T_older_newer;
    const double depth_m = pose_graph.node(neighbour).mean_depth_m;
    if (registration::view_distance(camera, depth_m, expected) > kFarthestNeighbour) continue;
    const auto beside = sight(pose_graph, neighbour);
    const auto other = beside ? align(*beside, *to, expected) : std::nullopt;
    if (!other) continue;
    if (!agree(*found, T_older_neighbour * other->T_older_newer)) return std::nullopt;
    ++confirmed;
  }
  if (confirmed == 0) return std::nullopt;
  return graph::Edge{older, newer, found->T_older_newer, found->information, true};
}

}  // namespace sgs::loops
