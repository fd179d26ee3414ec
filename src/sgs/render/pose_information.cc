// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/pose_information.h"

#include <algorithm>
#include <optional>

namespace sgs::render {
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
Eigen::Matrix2d structure_tensor(const Image<Rgbf>& color, int x, int y) {
  const Rgbf &left = color(x - 1, y), &right = color(x + 1, y);
  const Rgbf &upper = color(x, y - 1), &lower = color(x, y + 1);
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

Matrix6d pose_information(const TrainingImage& image, const LossConfig& loss) {
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
      const double weight = loss.depth_form == DepthForm::kAlphaRelative
                                ? depth_curvature / std::max(z, 0.3)
                                : depth_curvature;
      const RowVector6d change = flow.depth - *slope * flow.pixel;
      information.noalias() += weight * change.transpose() * change;
    }
  }
  return kStep * kStep * information;
}

}  // namespace sgs::render
