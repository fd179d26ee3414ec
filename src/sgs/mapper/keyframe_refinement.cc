// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe_refinement.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sgs::mapper {
namespace {

using RowVector6d = Eigen::Matrix<double, 1, 6>;

/// How a point seen at a pixel moves under T_world_camera * exp(xi), per xi.
struct Flow {
  Eigen::Matrix<double, 2, 6> pixel;  ///< in the image
  RowVector6d depth;                  ///< along the optical axis
};

Flow flow_of(const PinholeCamera& camera, int x, int y, double z) {
  const Eigen::Vector3d p = camera.back_project(x, y, z);
  Eigen::Matrix<double, 3, 6> point;
  point << hat(p), -Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 2, 3> projection;
  projection << camera.fx / z, 0, -camera.fx * p.x() / (z * z), 0, camera.fy / z,
      -camera.fy * p.y() / (z * z);
  return {projection * point, point.row(2)};
}

/// Sum over the channels of the products of the colour's slopes, per pixel squared.
Eigen::Matrix2d structure_tensor(const Image<render::Rgbf>& color, int x, int y) {
  const render::Rgbf &left = color(x - 1, y), &right = color(x + 1, y);
  const render::Rgbf &upper = color(x, y - 1), &lower = color(x, y + 1);
  Eigen::Matrix<float, 3, 2> slope;
  slope << right.r - left.r, lower.r - upper.r, right.g - left.g, lower.g - upper.g,
      right.b - left.b, lower.b - upper.b;
  slope *= 0.5f;
  return (slope.transpose() * slope).cast<double>();
}

/// Slope of the depth where it is measured all around and has no step of more than `edge` z.
std::optional<Eigen::RowVector2d> depth_slope(const DepthImage& depth, int x, int y, double edge) {
  const auto z = static_cast<double>(depth(x, y));
  const Eigen::Vector4d around(
      static_cast<double>(depth(x - 1, y)), static_cast<double>(depth(x + 1, y)),
      static_cast<double>(depth(x, y - 1)), static_cast<double>(depth(x, y + 1)));
  if (!(z > 0 && around.minCoeff() > 0)) return {};
  const Eigen::RowVector2d slope(0.5 * (around[1] - around[0]), 0.5 * (around[3] - around[2]));
  if (2 * slope.cwiseAbs().maxCoeff() > edge * z) return {};
  return slope;
}

/// 0 when nothing is measured.
double mean_of_measured(const DepthImage& depth) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float z = depth.data()[i];
    if (!(z > 0)) continue;
    sum += static_cast<double>(z);
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace

void update_gain(MapKeyframe& keyframe, const std::array<double, 3>& measured,
                 const std::array<double, 3>& rendered, double prior, double step) {
  constexpr double kMinSum = 100, kMinGain = 0.5, kMaxGain = 2;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!(rendered[c] > kMinSum)) continue;
    const double target =
        std::clamp((measured[c] / rendered[c] + prior) / (1 + prior), kMinGain, kMaxGain);
    keyframe.gain[c] += static_cast<float>(step * (target - static_cast<double>(keyframe.gain[c])));
  }
}

ExposureSums exposure_sums(const MapKeyframe& keyframe, const render::Rendering& rendering) {
  constexpr int kStep = 3;
  const int scale = rendering_scale(rendering, keyframe.camera());
  const auto pictures = keyframe.pictures();
  ExposureSums sums;
  for (int y = 0; y < keyframe.camera().height; y += kStep) {
    for (int x = 0; x < keyframe.camera().width; x += kStep) {
      const int u = std::min(x / scale, rendering.alpha.width() - 1);
      const int v = std::min(y / scale, rendering.alpha.height() - 1);
      if (rendering.alpha(u, v) <= 0.9f || pictures->depth_m(x, y) <= 0) continue;
      const Rgb8& c = pictures->color(x, y);
      const render::Rgbf& r = rendering.color(u, v);
      const std::array<double, 3> measured = {c.r / 255.0, c.g / 255.0, c.b / 255.0};
      const std::array<double, 3> rendered = {r.r, r.g, r.b};
      for (std::size_t k = 0; k < 3; ++k) {
        if (measured[k] <= 0.02 || measured[k] >= 0.97) continue;
        sums.measured[k] += measured[k];
        sums.rendered[k] += rendered[k];
      }
    }
  }
  return sums;
}

Matrix6d pose_information(const render::TrainingImage& image, const render::LossConfig& loss) {
  constexpr int kStep = 3;
  constexpr double kColorResidual = 0.03, kDepthResidual_m = 0.02;
  constexpr double kSmooth = 0.05;  // a depth step of more than this share is an edge
  const double mean_depth = mean_of_measured(image.depth);
  if (!(mean_depth > 0)) return Matrix6d::Zero();
  const double color_curvature =
      static_cast<double>(loss.color_weight) /
      (loss.color_knee > 0 ? static_cast<double>(loss.color_knee) : kColorResidual);
  const double depth_curvature = static_cast<double>(loss.depth_weight) /
                                 std::max(static_cast<double>(loss.depth_knee_m), kDepthResidual_m);
  Matrix6d information = Matrix6d::Zero();
  for (int y = 1; y + 1 < image.depth.height(); y += kStep) {
    for (int x = 1; x + 1 < image.depth.width(); x += kStep) {
      const auto measured = static_cast<double>(image.depth(x, y));
      const double z = measured > 0 ? measured : mean_depth;
      const Flow flow = flow_of(image.camera, x, y, z);
      if (measured > 0 || !loss.color_only_where_depth) {
        information.noalias() += color_curvature * flow.pixel.transpose() *
                                 structure_tensor(image.color, x, y) * flow.pixel;
      }
      const std::optional<Eigen::RowVector2d> slope = depth_slope(image.depth, x, y, kSmooth);
      if (!slope) continue;
      const double weight = loss.depth_form == render::DepthForm::kAlphaRelative
                                ? depth_curvature / std::max(z, 0.3)
                                : depth_curvature;
      const RowVector6d change = flow.depth - *slope * flow.pixel;
      information.noalias() += weight * change.transpose() * change;
    }
  }
  return kStep * kStep * information;
}

void refine_pose(MapKeyframe& keyframe, const Vector6d& gradient, double pixels,
                 const KeyframeRefinementConfig& config) {
  // The loss is far from quadratic over more than this.
  constexpr double kLongestStep = 5e-3;  // radians and metres
  if (!gradient.allFinite()) return;
  Vector6d prior;
  prior << Eigen::Vector3d::Constant(pixels * config.pose_prior_rotation),
      Eigen::Vector3d::Constant(pixels * config.pose_prior_translation);
  const Vector6d offset = (keyframe.T_odom_camera.inverse() * keyframe.T_world_camera).log();
  Matrix6d information =
      keyframe.pose_information ? *keyframe.pose_information : Matrix6d(Matrix6d::Zero());
  information.diagonal() += prior;
  // Keeps directions that nothing determines where they are.
  information.diagonal().array() += 1e-2 * pixels;
  Vector6d step =
      config.pose_share * information.ldlt().solve(gradient + prior.cwiseProduct(offset));
  if (!step.allFinite()) return;
  if (step.norm() > kLongestStep) step *= kLongestStep / step.norm();
  keyframe.T_world_camera = (keyframe.T_world_camera * SE3::exp(-step)).normalized();
}

}  // namespace sgs::mapper
