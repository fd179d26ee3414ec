// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Trackers for tests.

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "sgs/tracker/odometry.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// What make_tracker() makes; a failure fails the test.
inline std::unique_ptr<Odometry> must_make(const TrackerConfig& config, const PinholeCamera& camera,
                                           const SE3& T_world_first) {
  auto made = make_tracker(config, camera, T_world_first);
  EXPECT_TRUE(made.has_value());
  return std::make_unique<Odometry>(std::move(*made));
}

}  // namespace sgs::tracker
