// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/geometry/trajectory.h"
#include "sgs/synthetic/clocks.h"
#include "sgs/synthetic/sensor.h"
#include "sgs/synthetic/source.h"

namespace sgs::synthetic {

/// Longest gap between two poses of a given trajectory.
inline constexpr double kMaxPoseGap_s = 0.5;

/// Options as they can be used, or what is wrong with them.
Status check_options(const SynthOptions& options);
/// The scene's surfaces, laid out around the motion before it is held or turned.
Result<std::shared_ptr<const Scene>> scene_of(SynthOptions options, ThreadPool& pool);
/// How the camera moves.
Result<Trajectory> motion_of(const SynthOptions& options);
/// The same however few frames are asked for: what the layout and the people follow.
Result<Trajectory> whole_motion_of(SynthOptions options);

/// When the frames of a sequence are taken, and from where.
struct Schedule {
  double start_s = 0;
  std::vector<FrameTimes> frames;
  Trajectory truth;  ///< at the middle of colour's exposure, at the frames' stamps
};
Schedule schedule_of(const SynthOptions& options, const Trajectory& motion, const Sensor& sensor);

/// Poses of the camera that reads its rows one after the other, in the middle at `time_s`; one for
/// all where that takes no time.
std::vector<SE3> row_poses(const Trajectory& motion, const PinholeCamera& camera, double time_s,
                           double readout_s);

}  // namespace sgs::synthetic
