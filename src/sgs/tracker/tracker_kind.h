// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

// What is known of a tracker before there is one, from its configuration alone. All else a Tracker
// answers itself.

/// Whether it takes poses that come with the frames, and their world; all others find poses of
/// their own, in the world of their first frame.
bool takes_given_poses(const TrackerConfig& config);
/// Whether it calls a direction degenerate by what a measurement there adds to what is known of it
/// (TrackDiagnostics), and not by the condition of the solve.
bool decides_by_snr(const TrackerConfig& config);
/// Whether planarity, too, has a say in how much a prior counts.
bool weighs_planarity(const TrackerConfig& config);

}  // namespace sgs::tracker
