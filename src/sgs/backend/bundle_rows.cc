// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/bundle_rows.h"

#include <algorithm>
#include <cmath>

#include "sgs/camera/depth_noise.h"

namespace sgs::backend {
namespace {

constexpr double kNearest_m = 0.1;
// A pixel is hidden where depth differs by more than this.
constexpr double kGate_m = 0.05, kGateRatio = 0.03;
// Where the picture is this steep (grey per pixel), what it is wrong by beside its noise (sampling,
// blur, another resolution) weighs as much as the noise.
constexpr double kSteep = 30;

/// dr/dX of a residual whose image gradient is (gu, gv) per pixel.
Eigen::RowVector3d image_gradient(double gu, double gv, const PinholeCamera& camera,
                                  const Eigen::Vector3d& X) {
  const double inverse_z = 1 / X.z();
  const double gx = gu * camera.fx * inverse_z, gy = gv * camera.fy * inverse_z;
  return {gx, gy, -(gx * X.x() + gy * X.y()) * inverse_z};
}

/// Place of a row in the readout, -0.5 .. 0.5.
double row_offset(double v, const PinholeCamera& camera) {
  return std::clamp((v + 0.5) / camera.height - 0.5, -0.5, 0.5);
}

/// By how much a camera twist moves a point out of the camera's frame, with a minus sign.
Eigen::Vector3d sweep(const Vector6d& twist, const Eigen::Vector3d& X) {
  return twist.head<3>().cross(X) + twist.tail<3>();
}

/// Whether a pixel of a level can be interpolated, gradient and all.
bool inside(const Eigen::Vector2d& at, const PinholeCamera& camera) {
  return at.x() >= 1 && at.y() >= 1 && at.x() < camera.width - 2 && at.y() < camera.height - 2;
}

GraySample look_up(const GrayPyramid::Level& level, const Eigen::Vector2d& at) {
  return level.interpolate(static_cast<float>(at.x()), static_cast<float>(at.y()));
}

}  // namespace

BundleRows::BundleRows(const BundleProblem& problem, const BundleState& state)
    : problem_(problem), state_(state) {
  for (std::size_t k = 0; k < problem.keyframes.size(); ++k) {
    T_camera_world_.push_back(state.T_world_camera[k].inverse());
    Vector6d& twist = readout_.emplace_back(problem.readout_s * problem.keyframes[k]->velocity);
    twist.head<3>() += state.readout_turns[k];
  }
}

SE3 BundleRows::relative(int target, int host) const {
  if (target == host) return {};
  return T_camera_world_[static_cast<std::size_t>(target)] *
         state_.T_world_camera[static_cast<std::size_t>(host)];
}

const Vector6d& BundleRows::readout(int keyframe) const {
  return readout_[static_cast<std::size_t>(keyframe)];
}

std::optional<HostPoint> BundleRows::point(int host, std::size_t pixel, int level) const {
  const auto i = static_cast<std::size_t>(host);
  const Keyframe& keyframe = *problem_.keyframes[i];
  const PinholeCamera& camera = keyframe.gray.level(0).camera;
  const auto& image = keyframe.gray.level(level);
  const Eigen::Vector2d full(keyframe.pixels[pixel].u, keyframe.pixels[pixel].v);
  const double scale = 1.0 / (1 << level);
  const Eigen::Vector2d at = (full.array() + 0.5) * scale - 0.5;
  if (!inside(at, image.camera)) return {};
  const double inverse_depth = state_.inverse_depths[i][pixel];
  HostPoint p;
  p.host = host;
  p.grey = double{look_up(image, at).intensity};
  if (std::isnan(p.grey)) return {};  // not seen
  p.row_offset = row_offset(full.y(), camera);
  const Eigen::Vector3d X_row = camera.back_project(full.x(), full.y(), 1 / inverse_depth);
  const Vector6d moved = p.row_offset * readout(host);
  p.X = X_row + sweep(moved, X_row);
  p.dX = -(X_row + moved.head<3>().cross(X_row)) / inverse_depth;
  return p;
}

bool BundleRows::grey(const HostPoint& p, int target, int level, BundleRow& row) const {
  const auto j = static_cast<std::size_t>(target), i = static_cast<std::size_t>(p.host);
  const Keyframe& keyframe = *problem_.keyframes[j];
  const auto& image = keyframe.gray.level(level);
  const SE3 T = relative(target, p.host);
  const Eigen::Vector3d X = T * p.X;
  if (X.z() < kNearest_m) return false;
  const PinholeCamera& full = keyframe.gray.level(0).camera;
  const double o = row_offset(full.project(X).y(), full);
  const Eigen::Vector3d X_row = X - o * sweep(readout(target), X);
  if (X_row.z() < kNearest_m) return false;
  const Eigen::Vector2d at = image.camera.project(X_row);
  if (!inside(at, image.camera)) return false;
  const GraySample s = look_up(image, at);
  if (std::isnan(s.intensity + s.gx + s.gy)) return false;  // not seen
  const Exposure &a = state_.exposures[i], &b = state_.exposures[j];
  const double gain = std::exp(b.log_gain - a.log_gain);
  const double expected = gain * (p.grey - a.offset);
  row.residual = double{s.intensity} - b.offset - expected;
  const Eigen::RowVector3d g = image_gradient(double{s.gx}, double{s.gy}, image.camera, X_row);
  const Eigen::RowVector3d g_host = g * T.R;
  const Eigen::Vector3d turn = X.cross(g.transpose());
  const Eigen::Vector3d turn_host = p.X.cross(g_host.transpose());
  row.by_target << -turn, -g.transpose(), -expected, -1.0, -o * turn;
  row.by_host << turn_host, g_host.transpose(), expected, gain, p.row_offset * turn_host;
  row.by_inverse_depth = g_host.dot(p.dX);
  const double steepness = std::hypot(double{s.gx}, double{s.gy}) / kSteep;
  row.sigma = std::sqrt(1 + steepness * steepness);
  row.target = target;
  row.is_depth = false;
  return true;
}

bool BundleRows::depth(const HostPoint& p, int target, BundleRow& row) const {
  const Keyframe& keyframe = *problem_.keyframes[static_cast<std::size_t>(target)];
  const PinholeCamera& camera = keyframe.gray.level(0).camera;
  const SE3 T = relative(target, p.host);
  const Eigen::Vector3d X = T * p.X;
  if (X.z() < kNearest_m) return false;
  const Eigen::Vector3d swept = sweep(keyframe.velocity, X);
  const double o = row_offset(camera.project(X).y(), camera);
  const Eigen::Vector3d X_d =
      X - (keyframe.depth_delay_s + state_.delay_s) * swept - o * sweep(readout(target), X);
  if (X_d.z() < kNearest_m) return false;
  const Eigen::Vector2d at = camera.project(X_d) - state_.shift_px;
  const auto plane = keyframe.inverse_depth.at(at.x(), at.y());
  if (plane.q <= 0) return false;
  row.grid = problem_.grid.at(at.x(), at.y(), camera);
  double offset = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    offset += row.grid.weight[k] * state_.offsets_per_m[row.grid.node[k]];
  }
  const double q = double{plane.q} + offset;
  if (q <= 0) return false;
  row.residual = q - 1 / X_d.z();
  const double z = 1 / q;
  if (std::abs(z - X_d.z()) > kGate_m + kGateRatio * z) return false;
  row.sigma = double{depth_sigma_m(static_cast<float>(z))} * q * q;
  const double su = double{plane.slope_u}, sv = double{plane.slope_v};
  Eigen::RowVector3d g = image_gradient(su, sv, camera, X_d);
  g.z() += 1 / (X_d.z() * X_d.z());
  const Eigen::RowVector3d g_host = g * T.R;
  row.by_target.setZero();
  row.by_host.setZero();
  if (target != p.host) {
    const Eigen::Vector3d turn = X.cross(g.transpose());
    const Eigen::Vector3d turn_host = p.X.cross(g_host.transpose());
    row.by_target << -turn, -g.transpose(), 0, 0, -o * turn;
    row.by_host << turn_host, g_host.transpose(), 0, 0, p.row_offset * turn_host;
  }
  row.by_inverse_depth = g_host.dot(p.dX);
  row.by_shift_and_delay << -su, -sv, -g.dot(swept);
  row.target = target;
  row.is_depth = true;
  return true;
}

}  // namespace sgs::backend
