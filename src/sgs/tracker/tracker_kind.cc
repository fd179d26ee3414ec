// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/tracker_kind.h"

namespace sgs::tracker {

bool takes_given_poses(const TrackerConfig& config) { return config.type == TrackerType::kGiven; }

bool decides_by_snr(const TrackerConfig& config) { return config.type == TrackerType::kSpectral; }

bool weighs_planarity(const TrackerConfig& config) { return config.type == TrackerType::kPaper; }

}  // namespace sgs::tracker
