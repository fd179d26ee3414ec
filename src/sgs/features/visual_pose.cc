// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/features/visual_pose.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>

#include "sgs/camera/opencv_threads.h"

namespace sgs::features {
namespace {

constexpr double kNear_m = 0.05;

// Huber weight of a whitened squared residual, and its cost.
double huber_weight(double squared, double k, double& cost) {
  const double r = std::sqrt(squared);
  if (r <= k) {
    cost += 0.5 * squared;
    return 1;
  }
  cost += k * (r - 0.5 * k);
  return k / r;
}

}  // namespace

ReprojectionLinearization linearize(const std::vector<Observation>& observations,
                                    const PinholeCamera& camera, const SE3& T_world_camera,
                                    double huber) {
  ReprojectionLinearization out;
  const SE3 T_camera_world = T_world_camera.inverse();
  for (const Observation& o : observations) {
    const Eigen::Vector3d p = T_camera_world * o.p_world;
    if (!(p.z() > kNear_m)) continue;
    const double iz = 1 / p.z();
    Eigen::Matrix<double, 3, 6> dp;  // of the point in the camera under T exp(xi)
    dp << hat(p), -Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 2, 3> dpi;
    dpi << camera.fx * iz, 0, -camera.fx * p.x() * iz * iz, 0, camera.fy * iz,
        -camera.fy * p.y() * iz * iz;
    const Eigen::Matrix<double, 2, 6> J = -(dpi * dp) / o.sigma_px;
    const Eigen::Vector2d r = (o.uv - camera.project(p)) / o.sigma_px;
    const double w = huber_weight(r.squaredNorm(), huber, out.cost);
    out.H += w * J.transpose() * J;
    out.b += w * J.transpose() * r;
    if (r.norm() <= huber) ++out.inliers;
    if (!(o.depth_m > 0 && o.depth_sigma_m > 0)) continue;
    const Eigen::Matrix<double, 1, 6> Jz = -dp.row(2) / o.depth_sigma_m;
    const double rz = (o.depth_m - p.z()) / o.depth_sigma_m;
    const double wz = huber_weight(rz * rz, huber, out.cost);
    out.H += wz * Jz.transpose() * Jz;
    out.b += wz * Jz.transpose() * rz;
  }
  return out;
}

VisualPose refine(const std::vector<Observation>& observations, const PinholeCamera& camera,
                  const SE3& T_start, const VisualPoseConfig& config) {
  VisualPose out;
  out.T_world_camera = T_start;
  out.matches = static_cast<int>(observations.size());
  if (out.matches < config.min_inliers) return out;
  auto l = linearize(observations, camera, T_start, config.huber);
  for (int i = 0; i < config.refine_iterations; ++i) {
    Matrix6d H = l.H;
    H.diagonal().array() += 1e-6 * (1 + H.diagonal().maxCoeff());
    const Vector6d xi = -H.ldlt().solve(l.b);
    if (!xi.allFinite()) break;
    const SE3 trial = (out.T_world_camera * SE3::exp(xi)).normalized();
    const auto next = linearize(observations, camera, trial, config.huber);
    if (!(next.cost <= l.cost)) break;
    out.T_world_camera = trial;
    l = next;
    if (xi.norm() < 1e-7) break;
  }
  out.information = l.H;
  out.inliers = l.inliers;
  out.verdict = l.inliers >= config.min_inliers ? Verdict::kOk : Verdict::kTooFewInliers;
  return out;
}

PnpResult pnp_ransac(const std::vector<Observation>& observations, const PinholeCamera& camera,
                     const VisualPoseConfig& config) {
  PnpResult out;
  if (observations.size() < 6) return out;
  keep_opencv_to_one_thread();
  // Far from the origin OpenCV's float arithmetic would lose digits: centre the points.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& o : observations) centre += o.p_world;
  centre /= static_cast<double>(observations.size());
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const auto& o : observations) {
    const Eigen::Vector3d p = o.p_world - centre;
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.emplace_back(o.uv.x(), o.uv.y());
  }
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Vec3d rotation, translation;
  std::vector<int> inliers;
  bool found = false;
  try {
    found = cv::solvePnPRansac(points, pixels, K, cv::noArray(), rotation, translation, false,
                               config.ransac_iterations,
                               static_cast<float>(config.ransac_threshold_px), 0.99, inliers);
  } catch (const cv::Exception&) {
    found = false;  // degenerate samples
  }
  if (!found) return out;
  const SE3 T_camera_centred(so3_exp({rotation[0], rotation[1], rotation[2]}),
                             {translation[0], translation[1], translation[2]});
  if (!T_camera_centred.all_finite()) return out;
  out.T_world_camera = SE3(Eigen::Matrix3d::Identity(), centre) * T_camera_centred.inverse();
  out.inliers = std::move(inliers);
  return out;
}

VisualPose frame_to_frame_prior(const OrbFrame& previous, const SE3& T_world_previous,
                                const OrbFrame& current, const VisualPoseConfig& config) {
  VisualPose out;
  out.T_world_camera = T_world_previous;
  std::vector<Observation> observations;
  for (const Match& m : match_cross_check(previous, current)) {
    const double z = static_cast<double>(previous.keypoints[static_cast<std::size_t>(m.a)].depth_m);
    if (!(z >= config.min_depth_m && z <= config.max_depth_m)) continue;
    const auto& uv = current.keypoints[static_cast<std::size_t>(m.b)].uv;
    observations.push_back({T_world_previous * previous.point(m.a), uv.cast<double>()});
  }
  out.matches = static_cast<int>(observations.size());
  if (out.matches < config.min_matches) return out;
  const PnpResult pnp = pnp_ransac(observations, current.camera, config);
  out.inliers = static_cast<int>(pnp.inliers.size());
  out.verdict = Verdict::kTooFewInliers;
  if (out.inliers < config.min_inliers) return out;
  const SE3 motion = T_world_previous.inverse() * pnp.T_world_camera;
  out.verdict = Verdict::kImplausibleMotion;
  if (!(motion.t.norm() <= config.max_translation_m &&
        motion.angle() <= config.max_rotation_deg * std::numbers::pi / 180)) {
    return out;
  }
  std::vector<Observation> kept;
  for (int i : pnp.inliers) kept.push_back(observations[static_cast<std::size_t>(i)]);
  out.T_world_camera = pnp.T_world_camera;
  out.information = linearize(kept, current.camera, pnp.T_world_camera, 1e9).H;
  out.verdict = Verdict::kOk;
  return out;
}

}  // namespace sgs::features
