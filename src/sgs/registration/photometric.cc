// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/photometric.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "sgs/registration/photometric_kernel.h"
#include "sgs/registration/pixel_selection.h"

namespace sgs::registration {
namespace {

using FullMatrix = Eigen::Matrix<double, kPhotometricUnknowns, kPhotometricUnknowns>;

// Eliminates gain and offset, whose prior keeps the 2x2 block regular.
void eliminate_brightness(const PhotometricSums& sums, const AffineBrightness& brightness,
                          const PhotometricConfig& config, PhotometricLinearization& out) {
  const FullMatrix& H = sums.H;
  const double wa = 1 / (config.gain_sigma * config.gain_sigma);
  const double wb = 1 / (config.offset_sigma * config.offset_sigma);
  out.H_brightness = H.bottomRightCorner<2, 2>();
  out.H_brightness.diagonal() += Eigen::Vector2d(wa, wb);
  out.b_brightness = sums.b.tail<2>();
  out.b_brightness += Eigen::Vector2d(wa * (brightness.gain - 1), wb * brightness.offset);
  constexpr int kPose = kPhotometricPose, kReadout = kPhotometricReadout;
  constexpr int kMotion = kPose + kReadout;
  const Eigen::Matrix<double, kMotion, 2> C = H.topRightCorner<kMotion, 2>();
  const Eigen::Matrix<double, kMotion, 2> G = C * out.H_brightness.inverse();
  Eigen::Matrix<double, kMotion, kMotion> motion =
      H.topLeftCorner<kMotion, kMotion>() - G * C.transpose();
  motion = (0.5 * (motion + motion.transpose())).eval();
  const Eigen::Matrix<double, kMotion, 1> b = sums.b.head<kMotion>() - G * out.b_brightness;
  out.H = motion.topLeftCorner<kPose, kPose>();
  out.H_pose_readout = motion.topRightCorner<kPose, kReadout>();
  out.H_readout = motion.bottomRightCorner<kReadout, kReadout>();
  out.b = b.head<kPose>();
  out.b_readout = b.tail<kReadout>();
  out.H_pose_brightness = C.topRows<kPose>();
  out.H_readout_brightness = C.bottomRows<kReadout>();
  out.cost += 0.5 * (wa * (brightness.gain - 1) * (brightness.gain - 1) +
                     wb * brightness.offset * brightness.offset);
}

}  // namespace

double PhotometricConfig::sigma_at(int level) const {
  return sigma * std::pow(sigma_level_factor, level);
}
double PhotometricConfig::gradient_threshold_at(int level) const {
  return gradient_threshold * std::pow(gradient_level_factor, level);
}
int PhotometricConfig::block_at(int level) const {
  return std::max(3, static_cast<int>(std::lround(block_px / std::pow(block_shrink, level))));
}

PhotometricReference::PhotometricReference(const GrayPyramid& pyramid, const DepthImage& depth,
                                           const SE3& T_world_keyframe,
                                           const PhotometricConfig& config,
                                           const SurfaceLookup& surface,
                                           const ReadoutMotion& readout)
    : T_world_keyframe_(T_world_keyframe) {
  SGS_CHECK(!pyramid.empty() && depth.width() == pyramid.level(0).camera.width &&
                depth.height() == pyramid.level(0).camera.height,
            "depth must have the size of the pyramid's finest level");
  constexpr float kFarthest_per_m = 0.02f;
  points_.resize(static_cast<std::size_t>(std::min(config.levels, pyramid.levels())));
  slopes_.resize(points_.size());
  for (int l = 0; l < levels(); ++l) {
    const auto& level = pyramid.level(l);
    auto& points = points_[static_cast<std::size_t>(l)];
    auto& slopes = slopes_[static_cast<std::size_t>(l)];
    const std::vector<SelectedPixel> selected = select_pixels(level.gray, l, depth, config);
    points.reserve(selected.size());  // keyframes stay: no room to grow is kept
    slopes.reserve(selected.size());
    for (const SelectedPixel& pixel : selected) {
      const int u = full_pixel(pixel.x, l, depth.width());
      const int v = full_pixel(pixel.y, l, depth.height());
      const InverseDepthPlane plane = surface ? surface(u, v) : InverseDepthPlane{};
      const float z = surface ? (plane.q > kFarthest_per_m ? 1 / plane.q : 0) : depth(u, v);
      if (!(z > kNearestPixel_m)) continue;
      const Eigen::Vector3f p_row =
          level.camera.back_project(pixel.x, pixel.y, static_cast<double>(z)).cast<float>();
      const float offset = ReadoutMotion::offset(static_cast<float>(pixel.y), level.gray.height());
      points.push_back({readout.to_middle(p_row, offset), level.gray(pixel.x, pixel.y)});
      slopes.emplace_back(plane.slope_u, plane.slope_v);
    }
  }
}

void PhotometricReference::change_depth(const DepthChange& change, const Vector6d& lag) {
  for (std::size_t l = 0; l < points_.size(); ++l) {
    for (std::size_t i = 0; i < points_[l].size(); ++i) {
      change.apply(points_[l][i].p_keyframe, slopes_[l][i], lag);
    }
  }
}

AffineBrightness PhotometricLinearization::updated(const AffineBrightness& before,
                                                   const Vector6d& xi,
                                                   const Eigen::Vector3d& readout_step) const {
  const Eigen::Vector2d rhs = b_brightness + H_pose_brightness.transpose() * xi +
                              H_readout_brightness.transpose() * readout_step;
  const Eigen::Vector2d step = -(H_brightness.inverse() * rhs);
  return {before.gain + step(0), before.offset + step(1)};
}

PhotometricLinearization linearize(const PhotometricReference& reference, int level,
                                   const GrayPyramid& current, const DepthImage& current_depth,
                                   const SE3& T_world_camera, const AffineBrightness& brightness,
                                   const PhotometricConfig& config, const ReadoutMotion& readout,
                                   bool readout_is_free, double noise, const CellMask* moving) {
  SGS_CHECK(level >= 0 && level < reference.levels() && level < current.levels(),
            "no such pyramid level");
  const SE3 T = T_world_camera.inverse() * reference.T_world_keyframe();
  const auto f = [](double x) { return static_cast<float>(x); };
  PhotometricView view;
  view.image = &current.level(level);
  view.depth = &current_depth;
  view.level = level;
  view.R = T.R.cast<float>();
  view.t = T.t.cast<float>();
  view.readout = readout;
  view.gain = f(brightness.gain);
  view.offset = f(brightness.offset);
  view.depth_gate_m = f(config.depth_gate_m);
  view.depth_gate_ratio = f(config.depth_gate_ratio);
  view.t_dof = f(config.t_dof);
  const double sigma = noise * config.sigma_at(level);
  view.inverse_variance = f(1 / (sigma * sigma));
  view.moving = moving;
  view.with_readout = readout_is_free;
  const PhotometricSums sums = sum_photometric(view, reference.points(level));

  PhotometricLinearization out;
  out.used = sums.used;
  out.visible = sums.visible;
  out.gone = sums.gone;
  out.square_sum = sums.square_sum;
  out.cost = 0.5 * (config.t_dof + 1) * sums.log_sum;
  eliminate_brightness(sums, brightness, config, out);
  return out;
}

}  // namespace sgs::registration
