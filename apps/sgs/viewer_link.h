// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/dataset/feed_item.h"
#include "sgs/eval/metrics.h"
#include "sgs/input/input.h"
#include "sgs/run/live_status.h"
#include "sgs/slam/session.h"

namespace sgs::app {

/// --viewer and its companions.
struct ViewerRequest {
  bool wanted = false;
  std::string port = "8765";
  std::string address = "127.0.0.1";
  std::vector<std::string> names;  ///< further Host names that are accepted
  bool stay = false;
  std::string token = {};  ///< of the run before this one, whose pages go on; empty: a new one

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
  /// Starts the server and prints its address to stderr. `starts_again`: the same input can be run
  /// once more. Null when no viewer is wanted; fails when it cannot listen or when this build has
  /// no viewer.
  static Result<std::unique_ptr<ViewerLink>> open(const ViewerRequest& request,
                                                  const run::Input& input,
                                                  const run::InputSpec& spec,
                                                  const slam::SessionConfig& config,
                                                  bool starts_again);
  /// The request for a run that goes on at the same address.
  virtual ViewerRequest same_address(ViewerRequest request) const = 0;
  /// Requested when a client wants the frames to end.
  virtual std::stop_token enough() const = 0;
  /// Before a frame is read: waits while a client has paused the run, and calls `held` meanwhile.
  /// Returns the seconds waited.
  virtual double before_frame(const std::function<void()>& held) = 0;
  /// What clients wish (run::RunObserver).
  virtual bool take_save() = 0;
  virtual std::optional<bool> take_recording() = 0;
  /// From any thread.
  virtual void on_saved(const run::SaveNote& note) = 0;
  virtual void on_status(const run::LiveStatus& now) = 0;
  /// Shows what came of a readable frame.
  virtual void after_frame(slam::Session& session, const dataset::FeedItem& item,
                           const slam::FrameRecord& record) = 0;
  /// The run is over: shows the final map.
  virtual void finish(slam::Session& session) = 0;
  /// The scores are there; the clients get what they lack (two seconds at most). With
  /// --viewer-stay serves until Ctrl-C; a run that a client has ended, as long as there are
  /// clients, and refines its map where they wish. `recording` was made on the way, or is empty.
  /// Returns whether the run is to start again.
  virtual bool close(const eval::Metrics& metrics, const std::filesystem::path& folder,
                     const std::filesystem::path& recording) = 0;
};

}  // namespace sgs::app
