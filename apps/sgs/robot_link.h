// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "sgs/core/error.h"
#include "sgs/dataset/feed_item.h"
#include "sgs/input/input.h"
#include "sgs/slam/session.h"

namespace sgs::app {

/// --ros1 or --ros2, and their companions.
struct RobotRequest {
  bool ros1 = false, ros2 = false;  ///< one of them at most
  std::optional<int> domain;
  std::string camera_frame, up;

  void add_run_options(CLI::App& sub);
};

/// What a run tells robots: a program beside `sgs` publishes it. Nothing here waits for anybody
/// but, offline, for that program. One thread.
class RobotLink {
 public:
  virtual ~RobotLink() = default;
  /// Null where nothing is wanted. `at_camera_rate`: rather leave out than wait. Fails where the
  /// program is not installed, and where the request makes no sense.
  static Result<std::unique_ptr<RobotLink>> open(const RobotRequest& request,
                                                 const run::Input& input, bool at_camera_rate);
  /// What came of a readable frame.
  virtual void after_frame(slam::Session& session, const dataset::FeedItem& item,
                           const slam::FrameRecord& record) = 0;
  /// The run is over: tells the last of it and ends the program.
  virtual void finish(slam::Session& session) = 0;
};

}  // namespace sgs::app
