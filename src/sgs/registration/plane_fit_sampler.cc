// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/plane_fit_sampler.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sgs/camera/depth_noise.h"
#include "sgs/registration/plane_window.h"

namespace sgs::registration {
namespace {

constexpr int kStride = 2;  // pixels between the samples of a window
constexpr int kPad = 4;     // columns of zeros, so that a window never leaves its row

}  // namespace

struct PlaneFitSampler::Fit {
  float alpha = 0, beta = 0, gamma = 0;  // q = alpha (u - u0) + beta (v - v0) + gamma
  float samples = 0;
  float rms = 0;
};

PlaneFitSampler::PlaneFitSampler(const SamplingConfig& config, const PinholeCamera& camera,
                                 bool with_ellipses)
    : config_(config),
      camera_(camera),
      with_ellipses_(with_ellipses),
      half_(std::clamp(config.window_px / 2 / kStride, 1, kPad - 1)) {
  SGS_CHECK(camera.valid(), "the sampler needs a usable camera");
}

void PlaneFitSampler::fill_inverse_depth(const DepthImage& depth) {
  const int columns = (depth.width() + 1) / kStride, rows = (depth.height() + 1) / kStride;
  if (inverse_depth_.height() != rows) {
    inverse_depth_ = Image<float>(columns + 2 * kPad + kWindowColumns, rows, 0.0f);
  }
  for (int j = 0; j < rows; ++j) {
    const float* z = depth.row(kStride * j);
    float* q = inverse_depth_.row(j) + kPad;
    for (int i = 0; i < columns; ++i) {
      const float d = z[kStride * i];
      const float inverse = 1.0f / std::max(d, 1e-3f);
      q[i] = d > 0 ? inverse : 0.0f;
    }
  }
}

bool PlaneFitSampler::fit_plane(int column, int row, float sigma_q, Fit& fit) const {
  const float q0 = inverse_depth_(column + kPad, row);
  fit = {0, 0, q0, 0, 0};
  const float radius = static_cast<float>(kStride * half_);
  const float focal = static_cast<float>(camera_.fx);
  const int row_begin = std::max(0, row - half_);
  const int row_end = std::min(inverse_depth_.height() - 1, row + half_);
  for (int round = 0; round < 2; ++round) {
    // A surface seen at about 72 degrees changes by 3 q / f per pixel.
    const float width = round == 0 ? 4 * sigma_q + 3 * q0 * radius / focal : 3 * sigma_q;
    const Window window{inverse_depth_.row(row_begin) + column + kPad - half_,
                        inverse_depth_.width(),
                        row_end - row_begin + 1,
                        half_,
                        static_cast<float>(kStride),
                        static_cast<float>(kStride * (row_begin - row))};
    const auto [n, x, y, xx, xy, yy, e, xe, ye, ee] =
        sum_window(window, {fit.alpha, fit.beta, fit.gamma, width});
    if (n < static_cast<float>(config_.min_samples)) return false;
    Eigen::Matrix3f A;
    A << xx, xy, x, xy, yy, y, x, y, n;
    if (A.determinant() < 1e-3f * n * n * n) return false;  // samples on a line
    const Eigen::Vector3f rhs(xe, ye, e);
    const Eigen::Vector3f step = A.inverse() * rhs;
    fit.alpha += step.x();
    fit.beta += step.y();
    fit.gamma += step.z();
    fit.samples = n;
    fit.rms = std::sqrt(std::max(0.0f, (ee - step.dot(rhs)) / n));
  }
  return fit.gamma > 0.02f;
}

InverseDepthPlane PlaneFitSampler::inverse_depth_plane(int u, int v) const {
  const int column = u / kStride, row = v / kStride;
  if (inverse_depth_.empty() || row >= inverse_depth_.height()) return {};
  const float q0 = inverse_depth_(column + kPad, row);
  if (!(q0 > 0)) return {};
  Fit fit;
  if (!fit_plane(column, row, depth_sigma_m(1 / q0) * q0 * q0, fit)) return {};
  const float q = fit.gamma + fit.alpha * static_cast<float>(u - kStride * column) +
                  fit.beta * static_cast<float>(v - kStride * row);
  const auto window = static_cast<float>((2 * half_ + 1) * (2 * half_ + 1));
  return {q, fit.alpha, fit.beta, fit.samples / window};
}

void PlaneFitSampler::sample(const DepthImage& depth, SourceCloud& cloud) {
  SGS_CHECK(depth.width() == camera_.width && depth.height() == camera_.height,
            "depth image and camera differ in size");
  cloud.points.clear();
  cloud.covariances.clear();
  fill_inverse_depth(depth);

  const float fx = static_cast<float>(camera_.fx), fy = static_cast<float>(camera_.fy);
  const float cx = static_cast<float>(camera_.cx), cy = static_cast<float>(camera_.cy);
  const float min_cosine =
      static_cast<float>(std::cos(config_.max_incidence_deg * std::numbers::pi / 180));
  const float floor2 = static_cast<float>(config_.noise_floor_m * config_.noise_floor_m);
  const float independent = static_cast<float>(config_.independent_samples);
  const float radius = static_cast<float>(kStride * half_);
  const float min_depth = static_cast<float>(config_.min_depth_m);
  const float max_depth = static_cast<float>(config_.max_depth_m);
  const int step = config_.step_px;
  Fit fit;
  for (int gv = step / 2; gv < depth.height(); gv += step) {
    for (int gu = step / 2; gu < depth.width(); gu += step) {
      const int u = gu - gu % kStride, v = gv - gv % kStride;
      const float z_measured = depth(u, v);
      if (!(z_measured >= min_depth && z_measured <= max_depth)) continue;
      const float sigma_z = depth_sigma_m(z_measured);
      const float sigma_q = sigma_z / (z_measured * z_measured);
      if (!fit_plane(u / kStride, v / kStride, sigma_q, fit)) continue;

      const float x = (static_cast<float>(u) - cx) / fx, y = (static_cast<float>(v) - cy) / fy;
      const float ax = fit.alpha * fx, by = fit.beta * fy;
      const Eigen::Vector3f N(ax, by, fit.gamma - ax * x - by * y);
      const float length = N.norm();
      const Eigen::Vector3f ray(x, y, 1.0f);
      SourcePoint p;
      p.point = ray / fit.gamma;
      p.normal = N / -length;  // N.p = 1: the normal that faces the camera is the other one
      const float along = -p.normal.dot(ray);
      if (!(along > min_cosine * ray.norm())) continue;

      const float excess = fit.rms / (1.5f * sigma_q);
      const float sigma = sigma_z * along;
      p.variance_m2 = (sigma * sigma / independent + floor2) * std::max(1.0f, excess * excess);
      p.normal_sigma = fx * sigma_q / (length * std::sqrt(fit.samples * radius * radius / 3));
      p.u = static_cast<std::uint16_t>(u);
      p.v = static_cast<std::uint16_t>(v);
      cloud.points.push_back(p);
      if (with_ellipses_) {
        cloud.covariances.push_back(
            plane_ellipse(p.normal, static_cast<float>(config_.covariance_floor)));
      }
    }
  }
}

}  // namespace sgs::registration
