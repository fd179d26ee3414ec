// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/internal/convert.h"

#include <cmath>

namespace sgs::api::internal {
namespace {

// limit: side of the images of a camera that a program gives, px
constexpr int kLargestSide_px = 16384;
constexpr int kSmallestSide_px = 8;  // nothing can be tracked in less

tl::unexpected<sgs::Error> bad_argument(std::string message, std::string remedy) {
  return fail(sgs::ErrorCode::kInvalidArgument, std::move(message), std::move(remedy));
}

}  // namespace

Camera to_api(const PinholeCamera& camera) {
  return {camera.width, camera.height, camera.fx, camera.fy,
          camera.cx,    camera.cy,     {},        Lens::kBrown};
}

Pose to_api(const SE3& T) {
  Pose pose = kIdentityPose;
  for (int r = 0; r < 3; ++r) {
    const auto row = static_cast<std::size_t>(4 * r);
    for (int c = 0; c < 3; ++c) pose[row + static_cast<std::size_t>(c)] = T.R(r, c);
    pose[row + 3] = T.t(r);
  }
  return pose;
}

Trajectory to_api(const sgs::Trajectory& trajectory) {
  Trajectory out;
  for (const StampedPose& pose : trajectory.poses()) {
    out.times.push_back(pose.timestamp_s);
    out.poses.push_back(to_api(pose.T_world_camera));
  }
  return out;
}

Result<LensCamera> from_api(const Camera& camera) {
  LensCamera lens;
  lens.camera = {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy};
  const auto fits = [](int side) { return side >= kSmallestSide_px && side <= kLargestSide_px; };
  if (!lens.camera.valid() || !fits(camera.width) || !fits(camera.height)) {
    return bad_argument(
        fmt::format("a camera of {}x{} pixels with fx {}, fy {}, cx {}, cy {} cannot be",
                    camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy),
        fmt::format("sizes are {} to {} pixels, focal lengths positive", kSmallestSide_px,
                    kLargestSide_px));
  }
  const bool fisheye = camera.lens == Lens::kFisheye;
  const auto distortion = Distortion::from_coefficients(
      camera.distortion, fisheye ? LensModel::kFisheye : LensModel::kBrown);
  bool finite = distortion.has_value();
  for (const double k : camera.distortion) finite = finite && std::isfinite(k);
  if (!finite) {
    return bad_argument(
        fmt::format("{} distortion coefficients cannot be used", camera.distortion.size()),
        fisheye ? "give 0 or 4 finite ones of a fisheye, k1 k2 k3 k4"
                : "give 0, 4, 5 or 8 finite ones in OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6");
  }
  lens.distortion = *distortion;
  return lens;
}

Result<SE3> from_api(const Pose& pose) {
  constexpr double kRounded = 1e-6, kRigid = 1e-3;  // of the entries of R'R
  SE3 T;
  for (int r = 0; r < 3; ++r) {
    const auto row = static_cast<std::size_t>(4 * r);
    for (int c = 0; c < 3; ++c) T.R(r, c) = pose[row + static_cast<std::size_t>(c)];
    T.t(r) = pose[row + 3];
  }
  const double off = (T.R.transpose() * T.R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const bool last_row = pose[12] == 0 && pose[13] == 0 && pose[14] == 0 && pose[15] == 1;
  if (!T.all_finite() || !(off < kRigid) || T.R.determinant() < 0 || !last_row) {
    return bad_argument("a pose is no rigid motion",
                        "give T_world_camera as [R t; 0 0 0 1] with a rotation R, metres");
  }
  return off < kRounded ? T : T.normalized();
}

Result<sgs::Trajectory> from_api(const Trajectory& trajectory) {
  if (trajectory.times.size() != trajectory.poses.size()) {
    return bad_argument(fmt::format("a trajectory of {} times and {} poses",
                                    trajectory.times.size(), trajectory.poses.size()),
                        "give as many of both");
  }
  sgs::Trajectory out;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const double time = trajectory.times[i];
    if (!std::isfinite(time) || (i > 0 && !(time > trajectory.times[i - 1]))) {
      return bad_argument(
          fmt::format("time {} ({}) of a trajectory is not later than the last", i, time),
          "times are finite seconds and rise");
    }
    SGS_ASSIGN_OR_RETURN(const SE3 T, from_api(trajectory.poses[i]));
    out.push_back({time, T});
  }
  return out;
}

}  // namespace sgs::api::internal
