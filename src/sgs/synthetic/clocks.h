// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/synthetic/sensor_model.h"

namespace sgs::synthetic {

/// When the images of one frame are taken, and what their stamps say. Seconds.
struct FrameTimes {
  std::int64_t slot = 0;       ///< number of the colour image, images that got lost counted
  double color_s = 0;          ///< middle of the exposure of colour's middle row
  double depth_s = 0;          ///< middle of depth's readout
  double stamp_s = 0;          ///< of colour
  double stamped_delay_s = 0;  ///< stamp of depth minus that of colour
};

/// The pairs that a recording of two free-running cameras gives: both run from `start_s` to
/// `end_s`, colour at `rate_hz`, depth at 30 Hz or faster, each within its model; images are paired
/// by their stamps as a reader of recordings does it (dataset/association.h, 20 ms).
std::vector<FrameTimes> free_running_frames(const ClockModel& model, double start_s, double end_s,
                                            double rate_hz, std::uint64_t seed);

}  // namespace sgs::synthetic
