// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "sgs/camera/depth_change.h"
#include "sgs/camera/pyramid.h"
#include "sgs/core/config.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/cell_mask.h"
#include "sgs/registration/cloud_sampler.h"
#include "sgs/registration/rolling_shutter.h"

namespace sgs::registration {

/// Settings of direct photometric alignment. Level 0 is the full image; noise and gradient
/// threshold shrink with the level because the 2x2 means remove noise and contrast.
struct PhotometricConfig {
  int levels = 5;
  double block_px = 12;
  double block_shrink = 1.6;
  double gradient_threshold = 3;
  double gradient_level_factor = 0.5;
  double sigma = 8;
  double sigma_level_factor = 0.6;
  bool estimate_noise = true;
  double t_dof = 5;
  double max_depth_m = 5;
  double depth_gate_m = 0.05;
  double depth_gate_ratio = 0.03;
  double gain_sigma = 0.5;
  double offset_sigma = 50;

  void declare(ParameterList& p) {
    p.add("levels", levels, "Pyramid levels of photometric alignment.", "", {1, 8});
    p.add("block_px", block_px, "One pixel is selected per block of this size at level 0.", "px",
          {3, 100});
    p.add("block_shrink", block_shrink, "Division of the block size per level.", "", {1, 4});
    p.add("gradient_threshold", gradient_threshold,
          "Smallest gradient of a selected pixel at level 0.", "grey/px", {0, 255});
    p.add("gradient_level_factor", gradient_level_factor,
          "Factor on the gradient threshold per level.", "", {0.01, 2});
    p.add("sigma", sigma, "Noise of the grey difference at level 0.", "grey", {0.01, 255});
    p.add("sigma_level_factor", sigma_level_factor, "Factor on the noise per level.", "",
          {0.01, 2});
    p.add("estimate_noise", estimate_noise,
          "Learn from the recording how wide grey differences are at each level; off: as sigma "
          "says.");
    p.add("t_dof", t_dof, "Degrees of freedom of the t distribution of grey differences.", "",
          {1, 1000});
    p.add("max_depth_m", max_depth_m, "Largest depth of a selected pixel.", "m", {0.1, 100});
    p.add("depth_gate_m", depth_gate_m,
          "A pixel is hidden where the measured depth differs by more than this plus the ratio.",
          "m", {0, 10});
    p.add("depth_gate_ratio", depth_gate_ratio, "Part of the depth gate proportional to depth.", "",
          {0, 1});
    p.add("gain_sigma", gain_sigma, "Prior standard deviation of the exposure gain around 1.", "",
          {1e-6, 100});
    p.add("offset_sigma", offset_sigma, "Prior standard deviation of the brightness offset.",
          "grey", {1e-6, 1000});
  }
  double sigma_at(int level) const;
  double gradient_threshold_at(int level) const;
  int block_at(int level) const;
};

/// The surface at a pixel of the full image; none where its depth should not be used.
using SurfaceLookup = std::function<InverseDepthPlane(int u, int v)>;

/// A selected pixel of a keyframe: its 3D point in the keyframe's camera and its grey value.
struct PhotometricPoint {
  Eigen::Vector3f p_keyframe;  ///< metres
  float intensity = 0;         ///< 0..255
};

/// Pixels of a keyframe to which later frames are aligned: per level the one of highest gradient
/// in each block, with depth. Thread-safe unless it is moved.
class PhotometricReference {
 public:
  /// `depth` decides which pixels can be selected (a measurement within max_depth_m);
  /// `surface`, where given, supplies the depth that is used and drops the pixels for which there
  /// is none (an inverse-depth plane fit: depth edges and noise do not survive it). Points are
  /// kept as the middle row's camera sees them; `readout` is the motion that takes them there.
  PhotometricReference(const GrayPyramid& pyramid, const DepthImage& depth,
                       const SE3& T_world_keyframe, const PhotometricConfig& config,
                       const SurfaceLookup& surface = {}, const ReadoutMotion& readout = {});

  const SE3& T_world_keyframe() const { return T_world_keyframe_; }
  /// Follows a keyframe that refinement has moved.
  void set_pose(const SE3& T_world_keyframe) { T_world_keyframe_ = T_world_keyframe; }
  /// Follows depth that is known better now; `lag`: camera twist over what the delay has grown by.
  void change_depth(const DepthChange& change, const Vector6d& lag = Vector6d::Zero());
  int levels() const { return static_cast<int>(points_.size()); }
  const std::vector<PhotometricPoint>& points(int level) const {
    return points_[static_cast<std::size_t>(level)];
  }

 private:
  SE3 T_world_keyframe_;
  std::vector<std::vector<PhotometricPoint>> points_;
  std::vector<std::vector<Eigen::Vector2f>> slopes_;  // of inverse depth at them, 1/(m px)
};

/// I_current = gain * I_keyframe + offset. One per reference, carried along by the caller.
struct AffineBrightness {
  double gain = 1;
  double offset = 0;  ///< grey
};

/// Normal equations of one reference at one level: H xi = -b on twists of the current camera, gain
/// and offset eliminated by their Schur complement. Those of several references add up. The turn of
/// the camera during the readout (rolling_shutter.h) is a further unknown of the current frame,
/// common to all references, and left to the caller.
struct PhotometricLinearization {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  Eigen::Matrix<double, 6, 3> H_pose_readout = Eigen::Matrix<double, 6, 3>::Zero();
  Eigen::Matrix3d H_readout = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b_readout = Eigen::Vector3d::Zero();
  double cost = 0;  ///< sum (nu+1)/2 ln(1 + r^2/(nu sigma^2)) + the brightness prior
  /// Sum of w r^2: the noise is sqrt(square_sum / used) times as wide as it was taken to be, to the
  /// first step of its iteration (Kerl, Sturm, Cremers 2013, eq. 14).
  double square_sum = 0;
  int used = 0;     ///< pixels in the sums: inside the image and not hidden
  int visible = 0;  ///< pixels inside the image, hidden ones counted
  /// Pixels inside the image that are lost to what moves: hidden by it, or of it and gone.
  int gone = 0;

  Eigen::Matrix<double, 6, 2> H_pose_brightness = Eigen::Matrix<double, 6, 2>::Zero();
  Eigen::Matrix<double, 3, 2> H_readout_brightness = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Matrix2d H_brightness = Eigen::Matrix2d::Identity();
  Eigen::Vector2d b_brightness = Eigen::Vector2d::Zero();

  /// Gain and offset after the pose was moved by `xi` and the readout's rotation changed by
  /// `readout_step` (back substitution).
  AffineBrightness updated(const AffineBrightness& before, const Vector6d& xi,
                           const Eigen::Vector3d& readout_step = Eigen::Vector3d::Zero()) const;
};

/// Residual r = I(pi(T^-1 T_kf p)) - gain I_kf - offset, T = T_world_camera of the *current* frame
/// perturbed on the right, weights of the t distribution (Kerl, Sturm, Cremers: Robust Odometry
/// Estimation for RGB-D Cameras, ICRA 2013, eq. 13). With X the point in the current camera and
/// g = dI/dX: dr/dxi = [(g x X)^T, -g^T], dr/d(gain, offset) = [-I_kf, -1]; a readout at offset o
/// (`readout`) turns X by o times its rotation, so its derivative is o (g x X)^T.
/// A pixel is hidden where `current_depth` (full size; 0 = unknown passes) differs from its depth
/// by more than the gate. `readout_is_free` off leaves the derivatives by the readout out, which
/// are then zero. `noise`: by how much wider than config.sigma_at() residuals are. Deterministic
/// for a given instruction set, allocation-free, thread-safe.
PhotometricLinearization linearize(const PhotometricReference& reference, int level,
                                   const GrayPyramid& current, const DepthImage& current_depth,
                                   const SE3& T_world_camera, const AffineBrightness& brightness,
                                   const PhotometricConfig& config,
                                   const ReadoutMotion& readout = {}, bool readout_is_free = true,
                                   double noise = 1, const CellMask* moving = nullptr);

}  // namespace sgs::registration
