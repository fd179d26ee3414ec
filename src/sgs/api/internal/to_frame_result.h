// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/api/frame_result.h"
#include "sgs/slam/frame_record.h"

namespace sgs::api::internal {

FrameResult to_frame_result(const slam::FrameRecord& record);

}  // namespace sgs::api::internal
