// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/robot/smooth_odometry.h"

#include "sgs/core/error.h"

namespace sgs::robot {

Standing SmoothOdometry::step(const history::Path& path, std::int64_t frame) {
  const history::Path::Entry* entry = path.find(frame);
  SGS_CHECK(entry != nullptr, "a frame that is not in the path");
  const SE3& pose = entry->T_odom_camera;
  const history::Path::Entry* before = last_frame_ ? path.find(*last_frame_) : nullptr;
  now_.velocity.reset();
  if (!begun_) {
    now_.T_odom_camera = pose;
    begun_ = true;
  } else if (before == nullptr) {
    now_.T_map_odom = (pose * now_.T_odom_camera.inverse()).normalized();
  } else {
    const SE3& pose_before = before->T_odom_camera;
    const SE3 T_before_now = pose_before.inverse() * pose;
    const bool moved = !(pose_before.R == last_pose_.R && pose_before.t == last_pose_.t);
    if (moved) {
      now_.T_odom_camera = (now_.T_odom_camera * T_before_now).normalized();
      now_.T_map_odom = (pose * now_.T_odom_camera.inverse()).normalized();
    } else {
      now_.T_odom_camera = now_.T_map_odom.inverse() * pose;
    }
    const double step_s = entry->timestamp_s - last_s_;
    if (step_s > 0) {
      Vector6d velocity;
      velocity << so3_log(T_before_now.R), T_before_now.R.transpose() * T_before_now.t;
      now_.velocity = velocity / step_s;
    }
  }
  last_frame_ = frame;
  last_s_ = entry->timestamp_s;
  last_pose_ = pose;
  return now_;
}

}  // namespace sgs::robot
