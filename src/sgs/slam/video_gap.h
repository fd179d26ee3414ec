// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/geometry/trajectory.h"

namespace sgs::slam {

/// How many frames of a hand-held video at 30 a second lie between two views, the later one
/// counted: at least 1, at most `limit`. Time tells it; a jump that no video makes (is_sparse() has
/// the same limits) tells it too, at a centimetre or a degree a frame, for views that come without
/// times of their own.
double video_frames_between(const StampedPose& earlier, const StampedPose& later, double limit);

}  // namespace sgs::slam
