// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/session_feed.h"

#include "sgs/core/stopwatch.h"

namespace sgs::viewer {

SE3 pose_in_map(const SE3& T_odom_camera, const history::Path& path,
                const map::SnapshotPtr& snapshot) {
  if (!snapshot || snapshot->keyframe_frames.empty()) return T_odom_camera;
  const history::Path::Entry* newest = path.find(snapshot->keyframe_frames.back());
  if (newest == nullptr) return T_odom_camera;
  return snapshot->T_world_keyframe.back() * newest->T_odom_camera.inverse() * T_odom_camera;
}

FrameUpdate SessionFeed::update(slam::Session& session, const dataset::FeedItem& item,
                                const slam::FrameRecord& record) {
  FrameUpdate update;
  update.record = record;
  update.map = session.snapshot();
  update.frame = item.frame;
  update.T_world_camera = pose_in_map(record.T_online_camera, session.revision().path, update.map);
  if (const auto& truth = item.frame->truth_T_world_camera) {
    if (!T_world_truth_) T_world_truth_ = update.T_world_camera * truth->inverse();
    update.truth = *T_world_truth_ * *truth;
  }
  constexpr std::size_t kWindow = 20;
  times_s_.push_back(wall_time_s());
  if (times_s_.size() > kWindow + 1) times_s_.pop_front();
  const double span_s = times_s_.back() - times_s_.front();
  if (span_s > 0) update.fps = static_cast<double>(times_s_.size() - 1) / span_s;
  const double busy_s = session.mapper_busy_s();
  update.map_ms = 1e3 * (busy_s - mapper_busy_s_);
  mapper_busy_s_ = busy_s;
  return update;
}

}  // namespace sgs::viewer
