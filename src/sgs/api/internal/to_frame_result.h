// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/api/frame_result.h"
#include "sgs/slam/frame_record.h"

namespace sgs::api::internal {

/// `T_odom_camera`: where the camera was, as known now.
FrameResult to_frame_result(const slam::FrameRecord& record, const SE3& T_odom_camera);

}  // namespace sgs::api::internal
