// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/neighbour_sampler.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>

#include "sgs/camera/depth_noise.h"

namespace sgs::registration {
namespace {
constexpr int kNeighbours = 10;
constexpr int kReach = 2;  // grid steps searched on either side
}  // namespace

NeighbourSampler::NeighbourSampler(const SamplingConfig& config, const PinholeCamera& camera)
    : config_(config),
      camera_(camera),
      grid_(camera.width / config.step_px, camera.height / config.step_px,
            Eigen::Vector3f::Zero()) {
  SGS_CHECK(camera.valid(), "the sampler needs a usable camera");
}

bool NeighbourSampler::covariance_at(int column, int row, Eigen::Matrix3f& covariance) const {
  struct Candidate {
    float distance2;
    Eigen::Vector3f offset;
  };
  std::array<Candidate, (2 * kReach + 1) * (2 * kReach + 1)> candidates;
  std::size_t count = 0;
  const Eigen::Vector3f& centre = grid_(column, row);
  for (int j = std::max(0, row - kReach); j <= std::min(grid_.height() - 1, row + kReach); ++j) {
    for (int i = std::max(0, column - kReach); i <= std::min(grid_.width() - 1, column + kReach);
         ++i) {
      if (grid_(i, j).z() <= 0) continue;
      const Eigen::Vector3f offset = grid_(i, j) - centre;
      candidates[count++] = {offset.squaredNorm(), offset};
    }
  }
  if (count < kNeighbours) return false;
  std::nth_element(candidates.begin(), candidates.begin() + (kNeighbours - 1),
                   candidates.begin() + static_cast<std::ptrdiff_t>(count),
                   [](const auto& a, const auto& b) { return a.distance2 < b.distance2; });
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Matrix3f moment = Eigen::Matrix3f::Zero();
  for (int k = 0; k < kNeighbours; ++k) {
    const Eigen::Vector3f& d = candidates[static_cast<std::size_t>(k)].offset;
    mean += d;
    moment += d * d.transpose();
  }
  mean /= kNeighbours;
  covariance = moment / kNeighbours - mean * mean.transpose();
  return true;
}

void NeighbourSampler::sample(const DepthImage& depth, SourceCloud& cloud) {
  SGS_CHECK(depth.width() == camera_.width && depth.height() == camera_.height,
            "depth image and camera differ in size");
  cloud.points.clear();
  cloud.covariances.clear();
  const int step = config_.step_px;
  for (int j = 0; j < grid_.height(); ++j) {
    for (int i = 0; i < grid_.width(); ++i) {
      const int u = i * step + step / 2, v = j * step + step / 2;
      const float z = depth(u, v);
      const bool usable = z > static_cast<float>(config_.min_depth_m) &&
                          z <= static_cast<float>(config_.max_depth_m);
      grid_(i, j) = usable ? camera_.back_project(u, v, static_cast<double>(z)).cast<float>().eval()
                           : Eigen::Vector3f::Zero().eval();
    }
  }
  const float floor = static_cast<float>(config_.covariance_floor);
  const float noise_floor2 = static_cast<float>(config_.noise_floor_m * config_.noise_floor_m);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
  for (int j = 0; j < grid_.height(); ++j) {
    for (int i = 0; i < grid_.width(); ++i) {
      const Eigen::Vector3f& point = grid_(i, j);
      Eigen::Matrix3f covariance;
      if (point.z() <= 0 || !covariance_at(i, j, covariance)) continue;
      // Scaled first: the closed form works best near unit size.
      eigen.computeDirect(covariance / std::max(covariance.trace(), 1e-12f));
      const Eigen::Vector3f values =
          (eigen.eigenvalues() / std::max(eigen.eigenvalues().y(), 1e-9f)).cwiseMax(floor);
      const Eigen::Matrix3f& axes = eigen.eigenvectors();
      SourcePoint p;
      p.point = point;
      p.normal = axes.col(0);
      if (p.normal.dot(point) > 0) p.normal = -p.normal;
      const float along = depth_sigma_m(point.z()) * p.normal.dot(point) / point.z();
      p.variance_m2 = along * along + noise_floor2;
      p.u = static_cast<std::uint16_t>(i * step + step / 2);
      p.v = static_cast<std::uint16_t>(j * step + step / 2);
      cloud.points.push_back(p);
      cloud.covariances.push_back(axes * values.asDiagonal() * axes.transpose());
    }
  }
}

}  // namespace sgs::registration
