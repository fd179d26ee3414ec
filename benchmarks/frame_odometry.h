// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/geometry/se3.h"

namespace sgs::bench {

/// What another library's frame-to-frame odometry is asked for: the motion from the frame before to
/// this one as T_last_current, nullopt when it found none. Of the first frame the answer is not
/// used.
using FrameOdometry = std::function<std::optional<SE3>(const RgbdFrame& frame)>;

/// Plays a recorded sequence to `odometry` and prints the error of the path (as our own runs are
/// scored), the failed frames and the CPU time of a frame: the yardsticks of docs/results.md.
/// Returns the exit code. `make` gets the camera.
int run_frame_odometry(const std::string& label, const std::string& sequence,
                       const std::function<FrameOdometry(const PinholeCamera& camera)>& make);

}  // namespace sgs::bench
