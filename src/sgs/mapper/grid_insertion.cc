// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "sgs/camera/depth_noise.h"
#include "sgs/mapper/insertion.h"

namespace sgs::mapper {
namespace {

/// Principal axes of the covariance of the (up to) ten nearest sampled points in a 5x5 window.
struct LocalShape {
  Eigen::Matrix3f axes;    ///< columns, right-handed, smallest first
  Eigen::Vector3f sigmas;  ///< metres, rising
};
std::optional<LocalShape> local_shape(const Image<Eigen::Vector3f>& points, int i, int j) {
  constexpr int kReach = 2, kNeighbours = 10, kMinimum = 4;
  const Eigen::Vector3f centre = points(i, j);
  std::vector<std::pair<float, Eigen::Vector3f>> near;
  for (int dj = -kReach; dj <= kReach; ++dj) {
    for (int di = -kReach; di <= kReach; ++di) {
      if (!points.contains(i + di, j + dj) || points(i + di, j + dj).z() <= 0) continue;
      near.emplace_back((points(i + di, j + dj) - centre).squaredNorm(), points(i + di, j + dj));
    }
  }
  if (static_cast<int>(near.size()) < kMinimum) return std::nullopt;
  const auto used = std::min<std::size_t>(kNeighbours, near.size());
  // A stable order among equal distances keeps the result reproducible.
  std::stable_sort(near.begin(), near.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (std::size_t k = 0; k < used; ++k) mean += near[k].second / static_cast<float>(used);
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  for (std::size_t k = 0; k < used; ++k) {
    const Eigen::Vector3f d = near[k].second - mean;
    covariance += d * d.transpose() / static_cast<float>(used);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(covariance);
  LocalShape shape{solver.eigenvectors(), solver.eigenvalues().cwiseMax(1e-8f).cwiseSqrt()};
  if (shape.axes.determinant() < 0) shape.axes.col(0) *= -1;
  return shape;
}

}  // namespace

std::size_t insert_grid(const MapKeyframe& keyframe, int keyframe_index,
                        const InsertionConfig& config, map::GaussianStore& store) {
  constexpr double kReferenceWidth_px = 640;
  const PinholeCamera& camera = keyframe.camera();
  const auto pictures = keyframe.pictures();
  if (!pictures) return 0;
  const int step = std::max(
      1, static_cast<int>(std::lround(config.grid_step_px * camera.width / kReferenceWidth_px)));
  Image<Eigen::Vector3f> points(camera.width / step, camera.height / step, Eigen::Vector3f::Zero());
  for (int j = 0; j < points.height(); ++j) {
    for (int i = 0; i < points.width(); ++i) {
      const float z = pictures->depth(i * step, j * step);
      if (z <= 0 || !pictures->sees(i * step, j * step)) continue;
      points(i, j) = camera.back_project(i * step, j * step, z).cast<float>();
    }
  }
  const SE3& T = keyframe.T_world_camera;
  const auto opacity_logit = static_cast<float>(std::log(config.opacity / (1 - config.opacity)));
  const std::size_t before = store.size();
  for (int j = 0; j < points.height(); ++j) {
    for (int i = 0; i < points.width(); ++i) {
      const Eigen::Vector3f& p = points(i, j);
      if (p.z() <= 0) continue;
      const auto shape = local_shape(points, i, j);
      if (!shape) continue;
      const Eigen::Vector3f position = (T * p.cast<double>()).cast<float>();
      const Eigen::Quaterniond q(T.R * shape->axes.cast<double>());
      const Rgb8& color = pictures->color()(i * step, j * step);
      const float shrink = std::max(1.0f, 2 * std::pow(p.z(), 1.5f));
      map::Gaussian g{};
      for (int k = 0; k < 3; ++k) {
        g.mean[k] = position[k];
        g.log_scale[k] = std::log(shape->sigmas[k] / shrink);
      }
      const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
      for (int k = 0; k < 4; ++k) g.rotation[k] = static_cast<float>(wxyz[k]);
      g.opacity_logit = opacity_logit;
      g.rgb[0] = static_cast<float>(color.r) / 255;
      g.rgb[1] = static_cast<float>(color.g) / 255;
      g.rgb[2] = static_cast<float>(color.b) / 255;
      Eigen::Vector3f n = shape->axes.col(0);
      if (n.dot(p) > 0) n = -n;
      constexpr float kFree = 1e6f;
      store.append(
          g,
          {position, (T.R * n.cast<double>()).cast<float>(), depth_sigma_m(p.z()), keyframe_index},
          kFree);
    }
  }
  return store.size() - before;
}

}  // namespace sgs::mapper
