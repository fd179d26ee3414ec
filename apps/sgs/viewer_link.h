// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "input.h"
#include "play.h"
#include "sgs/core/error.h"
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
class ViewerLink : public Spectator {
 public:
  /// Starts the server and prints its address to stderr. Null when no viewer is wanted; fails when
  /// it cannot listen or when this build has no viewer.
  static Result<std::unique_ptr<ViewerLink>> open(const ViewerRequest& request, const Input& input,
                                                  const slam::SessionConfig& config);
  /// The run is over: shows the final map.
  virtual void finish(slam::Session& session) = 0;
  /// metrics.json is there; the clients get what they lack (two seconds at most). With
  /// --viewer-stay serves until Ctrl-C.
  virtual void close(const std::string& metrics_json, const std::filesystem::path& folder) = 0;
};

}  // namespace sgs::app
