// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/features/visual_map.h"

#include <algorithm>
#include <cmath>

#include "sgs/camera/depth_noise.h"

namespace sgs::features {
namespace {

constexpr int kCell_px = 20;
constexpr double kSecondBestRatio = 0.9;

// Features of one frame binned by pixel, for searches around a point.
class FeatureGrid {
 public:
  explicit FeatureGrid(const OrbFrame& frame)
      : columns_(frame.camera.width / kCell_px + 1), rows_(frame.camera.height / kCell_px + 1) {
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::size_t i = 0; i < frame.keypoints.size(); ++i) {
      const auto& uv = frame.keypoints[i].uv;
      cell(column(static_cast<double>(uv.x())), row(static_cast<double>(uv.y())))
          .push_back(static_cast<int>(i));
    }
  }
  template <class Visit>
  void visit(const Eigen::Vector2d& uv, double radius, const Visit& visit_feature) {
    for (int y = row(uv.y() - radius); y <= row(uv.y() + radius); ++y) {
      for (int x = column(uv.x() - radius); x <= column(uv.x() + radius); ++x) {
        for (int i : cell(x, y)) visit_feature(i);
      }
    }
  }

 private:
  int column(double u) const {
    return static_cast<int>(std::clamp(u / kCell_px, 0.0, static_cast<double>(columns_ - 1)));
  }
  int row(double v) const {
    return static_cast<int>(std::clamp(v / kCell_px, 0.0, static_cast<double>(rows_ - 1)));
  }
  std::vector<int>& cell(int x, int y) {
    return cells_[static_cast<std::size_t>(y * columns_ + x)];
  }
  int columns_, rows_;
  std::vector<std::vector<int>> cells_;
};

}  // namespace

int VisualMap::insert(OrbFrame frame, const SE3& T_world_keyframe) {
  keyframes_.push_back({std::move(frame), T_world_keyframe});
  return size() - 1;
}

void VisualMap::set_pose(int keyframe, const SE3& T_world_keyframe) {
  SGS_CHECK(keyframe >= 0 && keyframe < size(), "no such keyframe");
  keyframes_[static_cast<std::size_t>(keyframe)].T_world_keyframe = T_world_keyframe;
}

Observation VisualMap::observe(const Keyframe& keyframe, int point, const OrbFrame& current,
                               int feature) const {
  const Keypoint& k = current.keypoints[static_cast<std::size_t>(feature)];
  const Keypoint& source = keyframe.frame.keypoints[static_cast<std::size_t>(point)];
  Observation o;
  o.p_world = keyframe.T_world_keyframe * keyframe.frame.point(point);
  o.uv = k.uv.cast<double>();
  o.sigma_px = std::pow(config_.scale_factor, k.octave);
  o.depth_m = static_cast<double>(k.depth_m);
  o.depth_sigma_m = std::hypot(static_cast<double>(depth_sigma_m(k.depth_m)),
                               static_cast<double>(depth_sigma_m(source.depth_m)));
  return o;
}

VisualPose VisualMap::localise(const OrbFrame& current, const SE3& T_predicted) const {
  FeatureGrid grid(current);
  const SE3 T_camera_world = T_predicted.inverse();
  std::vector<Observation> observations;
  const int first = std::max(0, size() - config_.local_keyframes);
  for (int index = first; index < size(); ++index) {
    const Keyframe& keyframe = keyframes_[static_cast<std::size_t>(index)];
    const SE3 T = T_camera_world * keyframe.T_world_keyframe;
    std::vector<Match> best_for(current.keypoints.size());
    for (int i = 0; i < static_cast<int>(keyframe.frame.keypoints.size()); ++i) {
      const Keypoint& k = keyframe.frame.keypoints[static_cast<std::size_t>(i)];
      const double z = static_cast<double>(k.depth_m);
      if (!(z >= config_.min_depth_m && z <= config_.max_depth_m)) continue;
      const Eigen::Vector3d p = T * keyframe.frame.point(i);
      if (!(p.z() > config_.min_depth_m)) continue;
      const Eigen::Vector2d uv = current.camera.project(p);
      if (!(uv.x() >= 0 && uv.y() >= 0 && uv.x() < current.camera.width &&
            uv.y() < current.camera.height)) {
        continue;
      }
      Match best, second;
      grid.visit(uv, config_.search_radius_px, [&](int j) {
        const Keypoint& c = current.keypoints[static_cast<std::size_t>(j)];
        if (std::abs(c.octave - k.octave) > 1) return;
        if ((c.uv.cast<double>() - uv).norm() > config_.search_radius_px) return;
        const int d = hamming(keyframe.frame.descriptors.ptr<std::uint8_t>(i),
                              current.descriptors.ptr<std::uint8_t>(j));
        if (d < best.distance) {
          second = best;
          best = {i, j, d};
        } else if (d < second.distance) {
          second = {i, j, d};
        }
      });
      if (best.b < 0 || best.distance > config_.max_hamming) continue;
      if (best.distance > kSecondBestRatio * second.distance) continue;
      Match& slot = best_for[static_cast<std::size_t>(best.b)];
      if (best.distance < slot.distance) slot = best;
    }
    for (const Match& m : best_for) {
      if (m.a >= 0) observations.push_back(observe(keyframe, m.a, current, m.b));
    }
  }
  if (static_cast<int>(observations.size()) < config_.min_matches) {
    VisualPose out;
    out.T_world_camera = T_predicted;
    out.matches = static_cast<int>(observations.size());
    return out;
  }
  return refine(observations, current.camera, T_predicted, config_);
}

std::vector<int> VisualMap::relocalisation_candidates() const {
  std::vector<int> out;
  const int allowed = std::min(size(), config_.relocalisation_keyframes);
  const int newest = std::min(size(), (allowed + 1) / 2);
  for (int k = 0; k < newest; ++k) out.push_back(size() - 1 - k);
  const int older = size() - newest, choose = std::min(older, allowed - newest);
  for (int k = 0; k < choose; ++k) out.push_back(k * older / choose);
  return out;
}

VisualPose VisualMap::relocalise(const OrbFrame& current, std::size_t tried) const {
  struct Candidate {
    int keyframe;
    std::vector<Observation> observations;
    int alikeness;
  };
  std::vector<Candidate> candidates;
  VisualPose best;
  for (int index : relocalisation_candidates()) {
    const Keyframe& keyframe = keyframes_[static_cast<std::size_t>(index)];
    Candidate c{index, {}, 0};
    for (const Match& m : match_cross_check(keyframe.frame, current, config_.max_hamming)) {
      const double z =
          static_cast<double>(keyframe.frame.keypoints[static_cast<std::size_t>(m.a)].depth_m);
      if (z >= config_.min_depth_m && z <= config_.max_depth_m) {
        c.observations.push_back(observe(keyframe, m.a, current, m.b));
        c.alikeness += config_.max_hamming - m.distance;
      }
    }
    best.matches = std::max(best.matches, static_cast<int>(c.observations.size()));
    if (static_cast<int>(c.observations.size()) >= config_.min_matches) {
      candidates.push_back(std::move(c));
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.alikeness > b.alikeness; });
  if (candidates.size() > tried) candidates.resize(tried);
  if (!candidates.empty()) best.verdict = Verdict::kTooFewInliers;
  for (const Candidate& c : candidates) {
    const PnpResult pnp = pnp_ransac(c.observations, current.camera, config_);
    if (static_cast<int>(pnp.inliers.size()) < config_.min_inliers) continue;
    std::vector<Observation> kept;
    for (int i : pnp.inliers) kept.push_back(c.observations[static_cast<std::size_t>(i)]);
    VisualPose pose = refine(kept, current.camera, pnp.T_world_camera, config_);
    if (pose.inliers <= best.inliers) continue;
    if (pose.inliers < config_.relocalisation_min_inliers) pose.verdict = Verdict::kTooFewInliers;
    pose.keyframe = c.keyframe;
    best = pose;
  }
  return best;
}

}  // namespace sgs::features
