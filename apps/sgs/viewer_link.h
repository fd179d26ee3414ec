// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/dataset/feed_item.h"
#include "sgs/eval/metrics.h"
#include "sgs/input/input.h"
#include "sgs/slam/session.h"

namespace sgs::app {

/// --viewer and its companions.
struct ViewerRequest {
  bool wanted = false;
  std::string port = "8765";
  std::string address = "127.0.0.1";
  std::vector<std::string> names;  ///< further Host names that are accepted
  bool stay = false;

  /// Adds the options of `sgs run`; `input` is what stands in for the port when somebody writes
  /// `--viewer INPUT`.
  void add_run_options(CLI::App& sub, std::string& input);
  /// Adds --port, --viewer-address and --viewer-host for `sgs view`.
  void add_view_options(CLI::App& sub);
};

/// A run's live viewer as the command line sees it. Nothing here waits for a client but the
/// documented pauses.
class ViewerLink {
 public:
  virtual ~ViewerLink() = default;
  /// Starts the server and prints its address to stderr. Null when no viewer is wanted; fails when
  /// it cannot listen or when this build has no viewer.
  static Result<std::unique_ptr<ViewerLink>> open(const ViewerRequest& request,
                                                  const run::Input& input,
                                                  const slam::SessionConfig& config);
  /// Before a frame is read: waits while a client has paused the run. Returns the seconds waited.
  virtual double before_frame() = 0;
  /// Shows what came of a readable frame.
  virtual void after_frame(slam::Session& session, const dataset::FeedItem& item,
                           const slam::FrameRecord& record) = 0;
  /// The run is over: shows the final map.
  virtual void finish(slam::Session& session) = 0;
  /// The scores are there; the clients get what they lack (two seconds at most). With
  /// --viewer-stay serves until Ctrl-C.
  virtual void close(const eval::Metrics& metrics, const std::filesystem::path& folder) = 0;
};

}  // namespace sgs::app
