// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/agreeing_poses.h"

#include <algorithm>
#include <set>
#include <utility>

#include "sgs/graph/pose_graph.h"
#include "sgs/loops/drift.h"
#include "sgs/loops/pair_aligner.h"
#include "sgs/registration/view_distance.h"

namespace sgs::loops {
namespace {

constexpr int kNeighbours = 5;

/// What is asked of a view again and again.
struct Place {
  PinholeCamera camera;
  SE3 T_world_camera;
  double mean_depth_m = 0;
};

/// How sure a pose is that was estimated with the others.
Matrix6d known_information(const Place& place) {
  constexpr double kShare = 0.01;  // of the distance
  const double sigma_m = kShare * place.mean_depth_m;
  Matrix6d out = Matrix6d::Zero();
  out.diagonal().head<3>().setConstant(1 / (kShare * kShare));
  out.diagonal().tail<3>().setConstant(1 / (sigma_m * sigma_m));
  return out;
}

/// Of each view the later ones to align to it: every view and those nearest to it, each pair once.
std::vector<std::vector<std::size_t>> neighbours(const std::vector<Place>& places,
                                                 double farthest) {
  std::vector<std::set<std::size_t>> later(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t j = 0; j < places.size(); ++j) {
      if (i == j || places[i].mean_depth_m <= 0 || places[j].mean_depth_m <= 0) continue;
      const double distance = registration::view_distance(
          places[i].camera, places[i].mean_depth_m,
          places[i].T_world_camera.inverse() * places[j].T_world_camera);
      if (distance <= farthest) near.emplace_back(distance, j);
    }
    std::sort(near.begin(), near.end());
    near.resize(std::min<std::size_t>(near.size(), kNeighbours));
    for (const auto& [distance, j] : near) later[std::min(i, j)].insert(std::max(i, j));
  }
  std::vector<std::vector<std::size_t>> out;
  for (const auto& set : later) out.emplace_back(set.begin(), set.end());
  return out;
}

/// Edges from view `from` to those of `to`, nodes being numbered from one.
std::vector<graph::Edge> measured(const PosedViews& views, const std::vector<Place>& places,
                                  std::size_t from, const std::vector<std::size_t>& to,
                                  const LoopConfig& config,
                                  const alignment::AlignerConfig& config_of_aligner) {
  std::vector<graph::Edge> edges;
  if (to.empty()) return edges;
  const alignment::KnownView older = views.view(from);
  PairAligner aligner(config_of_aligner, older.frame, older.motion);
  for (const std::size_t k : to) {
    const alignment::KnownView newer = views.view(k);
    const SE3 T_start = places[from].T_world_camera.inverse() * places[k].T_world_camera;
    const auto a = aligner.align(newer.frame, newer.motion, T_start);
    const auto information = a ? information_of(*a, places[k].mean_depth_m, config) : std::nullopt;
    if (!information) continue;
    edges.push_back({static_cast<int>(from) + 1, static_cast<int>(k) + 1, a->T_reference_camera,
                     *information, true});
  }
  return edges;
}

}  // namespace

std::vector<SE3> agreeing_poses(const PosedViews& views, const LoopConfig& config,
                                const alignment::AlignerConfig& aligner, ThreadPool& pool) {
  std::vector<Place> places;
  for (std::size_t i = 0; i < views.count; ++i) {
    const alignment::KnownView view = views.view(i);
    places.push_back({view.frame.camera, view.T_world_camera,
                      registration::mean_depth(view.frame.depth, kFarthestDepth_m)});
  }
  const auto later = neighbours(places, config.revisit_distance);
  std::vector<std::vector<graph::Edge>> found(places.size());
  pool.run(static_cast<int>(places.size()), [&](int chunk, int) {
    const auto i = static_cast<std::size_t>(chunk);
    found[i] = measured(views, places, i, later[i], config, aligner);
  });
  // The first node is the world, which the poses that there are tie the views to.
  std::vector<SE3> poses = {SE3{}};
  std::vector<graph::Edge> edges;
  for (std::size_t i = 0; i < places.size(); ++i) {
    poses.push_back(places[i].T_world_camera);
    Place known = places[i];
    if (known.mean_depth_m <= 0) known.mean_depth_m = 1;
    edges.push_back({0, static_cast<int>(i) + 1, known.T_world_camera, known_information(known)});
  }
  for (const auto& some : found) edges.insert(edges.end(), some.begin(), some.end());
  graph::GraphSolution solution = graph::optimise(poses, edges);
  if (!solution.found) solution.T_world_node = std::move(poses);
  return {solution.T_world_node.begin() + 1, solution.T_world_node.end()};
}

}  // namespace sgs::loops
