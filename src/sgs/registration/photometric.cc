// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/photometric.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sgs::registration {
namespace {

constexpr int kFlush = 128;    // points per float sum
constexpr int kLogBatch = 16;  // factors per logarithm; (1 + r^2/5)^16 stays far below 1e308
constexpr float kNearPlane_m = 0.1f;

// Unknowns of one reference: pose, rotation of the readout, gain, offset; padded to whole vectors.
constexpr int kPose = 6, kReadout = 3, kUnknowns = 11, kPadded = 12;
using FullMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// Upper triangle of the normal equations: sums of at most kFlush points in float, then in double.
class Accumulator {
 public:
  void add(const float (&J)[kPadded], float weight, float residual) {
    for (int a = 0; a < kUnknowns; ++a) {
      const float wj = weight * J[a];
      // Whole vectors of four: faster than skipping the lower triangle element by element.
      for (int c = a - a % 4; c < kPadded; ++c) H_[a][c] += wj * J[c];
    }
    const float wr = weight * residual;
    for (int a = 0; a < kPadded; ++a) b_[a] += wr * J[a];
    if (++count_ % kFlush == 0) flush();
  }

  void flush() {
    for (int a = 0; a < kUnknowns; ++a) {
      for (int c = a; c < kUnknowns; ++c) H(a, c) += static_cast<double>(H_[a][c]);
      b(a) += static_cast<double>(b_[a]);
    }
    std::fill_n(&H_[0][0], kPadded * kPadded, 0.0f);
    std::fill_n(b_, kPadded, 0.0f);
  }

  int count() const { return count_; }
  FullMatrix H = FullMatrix::Zero();
  Eigen::Matrix<double, kUnknowns, 1> b = Eigen::Matrix<double, kUnknowns, 1>::Zero();

 private:
  alignas(16) float H_[kPadded][kPadded] = {};
  alignas(16) float b_[kPadded] = {};
  int count_ = 0;
};

// Sum of ln(1 + x) with one logarithm per batch.
class LogSum {
 public:
  void add(double one_plus_x) {
    product_ *= one_plus_x;
    if (++count_ == kLogBatch) fold();
  }
  double value() {
    fold();
    return sum_;
  }

 private:
  void fold() {
    sum_ += std::log(product_);
    product_ = 1;
    count_ = 0;
  }
  double sum_ = 0, product_ = 1;
  int count_ = 0;
};

// Centre of a level's pixel in the full image, rounded to a pixel.
int full_pixel(float level_coordinate, int level, int size) {
  const int full = static_cast<int>((level_coordinate + 0.5f) * static_cast<float>(1 << level));
  return std::min(full, size - 1);
}

// Eliminates gain and offset, whose prior keeps the 2x2 block regular.
void eliminate_brightness(const Accumulator& sums, const AffineBrightness& brightness,
                          const PhotometricConfig& config, PhotometricLinearization& out) {
  FullMatrix H = sums.H;
  H.triangularView<Eigen::StrictlyLower>() = sums.H.transpose();
  const double wa = 1 / (config.gain_sigma * config.gain_sigma);
  const double wb = 1 / (config.offset_sigma * config.offset_sigma);
  out.H_brightness = H.bottomRightCorner<2, 2>();
  out.H_brightness.diagonal() += Eigen::Vector2d(wa, wb);
  out.b_brightness = sums.b.tail<2>();
  out.b_brightness += Eigen::Vector2d(wa * (brightness.gain - 1), wb * brightness.offset);
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

void PhotometricConfig::declare(ParameterList& p) {
  p.add("levels", levels, "Pyramid levels of photometric alignment.", "", {1, 8});
  p.add("block_px", block_px, "One pixel is selected per block of this size at level 0.", "px",
        {3, 100});
  p.add("block_shrink", block_shrink, "Division of the block size per level.", "", {1, 4});
  p.add("gradient_threshold", gradient_threshold, "Smallest gradient of a selected pixel.",
        "grey/px", {0, 255});
  p.add("gradient_level_factor", gradient_level_factor,
        "Factor on the gradient threshold per level.", "", {0.01, 2});
  p.add("sigma", sigma, "Noise of the grey difference at level 0.", "grey", {0.01, 255});
  p.add("sigma_level_factor", sigma_level_factor, "Factor on the noise per level.", "", {0.01, 2});
  p.add("t_dof", t_dof, "Degrees of freedom of the t distribution of grey differences.", "",
        {1, 1000});
  p.add("max_depth_m", max_depth_m, "Largest depth of a selected pixel.", "m", {0.1, 100});
  p.add("depth_gate_m", depth_gate_m,
        "A pixel is hidden where the measured depth differs by more than this plus the ratio.", "m",
        {0, 10});
  p.add("depth_gate_ratio", depth_gate_ratio, "Part of the depth gate proportional to depth.", "",
        {0, 1});
  p.add("gain_sigma", gain_sigma, "Prior standard deviation of the exposure gain around 1.", "",
        {1e-6, 100});
  p.add("offset_sigma", offset_sigma, "Prior standard deviation of the brightness offset.", "grey",
        {1e-6, 1000});
}

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
                                           const DepthLookup& smooth_depth,
                                           const ReadoutMotion& readout)
    : T_world_keyframe_(T_world_keyframe) {
  SGS_CHECK(!pyramid.empty() && depth.width() == pyramid.level(0).camera.width &&
                depth.height() == pyramid.level(0).camera.height,
            "depth must have the size of the pyramid's finest level");
  const int margin = 2;
  points_.resize(static_cast<std::size_t>(std::min(config.levels, pyramid.levels())));
  for (int l = 0; l < levels(); ++l) {
    const auto& level = pyramid.level(l);
    const int block = config.block_at(l);
    const float threshold = static_cast<float>(config.gradient_threshold_at(l));
    const auto depth_at = [&](int x, int y) {
      return depth(full_pixel(static_cast<float>(x), l, depth.width()),
                   full_pixel(static_cast<float>(y), l, depth.height()));
    };
    for (int y0 = margin; y0 + block < level.gray.height() - margin; y0 += block) {
      for (int x0 = margin; x0 + block < level.gray.width() - margin; x0 += block) {
        float best = threshold * threshold;
        int bx = -1, by = -1;
        for (int y = y0; y < y0 + block; ++y) {
          const GraySample* row = level.samples.row(y);
          for (int x = x0; x < x0 + block; ++x) {
            const float g2 = row[x].gx * row[x].gx + row[x].gy * row[x].gy;
            if (!(g2 > best)) continue;
            const float z = depth_at(x, y);
            if (!(z > kNearPlane_m && z < config.max_depth_m)) continue;
            best = g2;
            bx = x;
            by = y;
          }
        }
        if (bx < 0) continue;
        float z = depth_at(bx, by);
        if (smooth_depth) {
          z = smooth_depth(full_pixel(static_cast<float>(bx), l, depth.width()),
                           full_pixel(static_cast<float>(by), l, depth.height()));
        }
        if (!(z > kNearPlane_m)) continue;
        const Eigen::Vector3f p_row =
            level.camera.back_project(bx, by, static_cast<double>(z)).cast<float>();
        const float offset = ReadoutMotion::offset(static_cast<float>(by), level.gray.height());
        points_[static_cast<std::size_t>(l)].push_back(
            {readout.to_middle(p_row, offset), level.gray(bx, by)});
      }
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
                                   const PhotometricConfig& config, const ReadoutMotion& readout) {
  SGS_CHECK(level >= 0 && level < reference.levels() && level < current.levels(),
            "no such pyramid level");
  const auto& image = current.level(level);
  const SE3 T = T_world_camera.inverse() * reference.T_world_keyframe();
  const Eigen::Matrix3f R = T.R.cast<float>();
  const Eigen::Vector3f t = T.t.cast<float>();
  const auto f = [](double x) { return static_cast<float>(x); };
  const float fx = f(image.camera.fx), fy = f(image.camera.fy);
  const float cx = f(image.camera.cx), cy = f(image.camera.cy);
  const float max_u = f(image.camera.width - 3), max_v = f(image.camera.height - 3);
  const float gain = f(brightness.gain), shade = f(brightness.offset);
  const float gate = f(config.depth_gate_m), gate_ratio = f(config.depth_gate_ratio);
  const float nu = f(config.t_dof);
  const float inverse_variance = f(1 / (config.sigma_at(level) * config.sigma_at(level)));

  PhotometricLinearization out;
  Accumulator sums;
  LogSum log_sum;
  for (const PhotometricPoint& point : reference.points(level)) {
    const Eigen::Vector3f X_middle = R * point.p_keyframe + t;
    if (!(X_middle.z() > kNearPlane_m)) continue;
    // The row that sees the point follows from where the middle row's camera would: the readout
    // moves it by a pixel or two, a negligible part of the picture's height.
    const float row = X_middle.y() / X_middle.z() * fy + cy;
    const float offset = std::clamp(ReadoutMotion::offset(row, image.camera.height), -0.5f, 0.5f);
    const Eigen::Vector3f X = readout.to_row(X_middle, offset);
    const float inverse_z = 1 / X.z(), x = X.x() * inverse_z, y = X.y() * inverse_z;
    const float u = x * fx + cx, v = y * fy + cy;
    if (!(u >= 2 && v >= 2 && u < max_u && v < max_v)) continue;
    ++out.visible;
    const float measured = current_depth(full_pixel(u, level, current_depth.width()),
                                         full_pixel(v, level, current_depth.height()));
    if (measured > 0 && std::abs(measured - X.z()) > gate + gate_ratio * X.z()) continue;

    const GraySample s = image.interpolate(u, v);
    const float residual = s.intensity - gain * point.intensity - shade;
    const float e2 = residual * residual * inverse_variance;
    log_sum.add(1 + static_cast<double>(e2 / nu));
    const float weight = (nu + 1) / (nu + e2) * inverse_variance;
    const float gX = s.gx * fx * inverse_z, gY = s.gy * fy * inverse_z, gZ = -(gX * x + gY * y);
    const float turn[3] = {gY * X.z() - gZ * X.y(), gZ * X.x() - gX * X.z(),
                           gX * X.y() - gY * X.x()};
    const float J[kPadded] = {
        turn[0],          turn[1],          turn[2],          -gX, -gY, -gZ, offset * turn[0],
        offset * turn[1], offset * turn[2], -point.intensity, -1,  0};
    sums.add(J, weight, residual);
  }
  sums.flush();
  out.used = sums.count();
  out.cost = 0.5 * (config.t_dof + 1) * log_sum.value();
  eliminate_brightness(sums, brightness, config, out);
  return out;
}

}  // namespace sgs::registration
