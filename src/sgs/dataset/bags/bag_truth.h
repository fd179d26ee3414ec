// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::dataset {

/// Ground truth of the camera from a bag. `option` is a topic of geometry_msgs/PoseStamped or
/// nav_msgs/Odometry, or "world:camera", two frames of tf, or empty: then the only pose topic whose
/// name says that it is the truth, if there is one. Poses of another body than `camera_frame` are
/// carried over to it where tf says how. Reads the whole topic; messages that are no poses, and all
/// after the clock was set back, are left out. Without `option` nothing here is an error: what
/// there is not, is not.
struct BagTruth {
  Trajectory poses;
  std::vector<std::string> warnings;
};
Result<BagTruth> read_bag_truth(const bag::Bag& bag, const std::string& option,
                                const std::string& camera_frame);

}  // namespace sgs::dataset
