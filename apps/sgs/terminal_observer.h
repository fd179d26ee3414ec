// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "progress.h"
#include "robot_link.h"
#include "sgs/run/run_observer.h"
#include "viewer_link.h"

namespace sgs::app {

/// Shows a run in the terminal, a bar for each of its stages, in browsers and to robots.
class TerminalObserver : public run::RunObserver {
 public:
  /// `frames`: of the recording, where that is known. `viewer` and `robot` may be null.
  TerminalObserver(std::optional<std::int64_t> frames, bool quiet, ViewerLink* viewer = nullptr,
                   RobotLink* robot = nullptr)
      : frames_(frames), quiet_(quiet), viewer_(viewer), robot_(robot) {}

  void on_calibration_frame() override;
  double before_frame(const std::function<void()>& held) override;
  bool take_save() override { return viewer_ != nullptr && viewer_->take_save(); }
  std::optional<bool> take_recording() override {
    return viewer_ != nullptr ? viewer_->take_recording() : std::nullopt;
  }
  void on_saved(const run::SaveNote& note) override {
    if (viewer_ != nullptr) viewer_->on_saved(note);
  }
  void on_status(const run::LiveStatus& now) override {
    if (viewer_ != nullptr) viewer_->on_status(now);
  }
  void on_frame(slam::Session& session, const dataset::FeedItem& item,
                const slam::FrameRecord& record) override;
  void on_map(slam::Session& session) override;
  void on_evaluation(const refine::Evaluation& now) override;
  void on_frames_scored(std::int64_t frames) override;
  /// Ends the line of the bar that is shown.
  void finish();

 private:
  Progress& bar(const std::string& what, std::optional<std::int64_t> total);

  std::optional<std::int64_t> frames_;
  bool quiet_;
  ViewerLink* viewer_;
  RobotLink* robot_;
  std::string stage_;  // of the bar
  std::optional<Progress> bar_;
  std::int64_t scored_ = 0;
};

}  // namespace sgs::app
