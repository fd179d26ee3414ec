// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "sgs/slam/live_feed.h"
#include "sgs/slam/session.h"
#include "sgs/viewer/frame_update.h"

namespace sgs::viewer {

/// Makes updates from a session, frame by frame, on the session's thread. Constant time but for a
/// search in the records; copies no image and no map.
class SessionFeed {
 public:
  /// `item` has just been fed and gave `record`.
  FrameUpdate update(slam::Session& session, const dataset::FeedItem& item,
                     const slam::FrameRecord& record);

 private:
  std::optional<SE3> T_world_truth_;
  std::deque<double> times_s_;  // of the last frames
  double mapper_busy_s_ = 0;
};

/// Carries a tracked pose into the refined map by the correction of its newest keyframe (what
/// PoseCorrection does behind its last pose).
SE3 pose_in_map(const SE3& T_odom_camera, const history::Path& path,
                const map::SnapshotPtr& snapshot);

}  // namespace sgs::viewer
