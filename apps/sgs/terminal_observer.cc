// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "terminal_observer.h"

#include <fmt/format.h>

namespace sgs::app {

Progress& TerminalObserver::bar(const std::string& what, std::optional<std::int64_t> total) {
  if (stage_ != what) {
    finish();
    bar_.emplace(what, total, quiet_);
    stage_ = what;
  }
  return *bar_;
}

void TerminalObserver::finish() {
  if (bar_) bar_->finish();
  bar_.reset();
  stage_.clear();
}

double TerminalObserver::before_frame(const std::function<void()>& held) {
  return viewer_ != nullptr ? viewer_->before_frame(held) : 0;
}

void TerminalObserver::on_frame(slam::Session& session, const dataset::FeedItem& item,
                                const slam::FrameRecord& record) {
  bar("frames", frames_)
      .step(record.bad
                ? std::string("bad frame")
                : fmt::format("{:<10} {} Gaussians", to_string(record.status), record.gaussians));
  if (viewer_ != nullptr && !record.bad) viewer_->after_frame(session, item, record);
  if (robot_ != nullptr && !record.bad) robot_->after_frame(session, item, record);
}

void TerminalObserver::on_map(slam::Session& session) {
  finish();
  if (viewer_ != nullptr) viewer_->finish(session);
  if (robot_ != nullptr) robot_->finish(session);
}

void TerminalObserver::on_evaluation(const refine::Evaluation& now) {
  if (now.steps > 0) bar("evaluations of the map", {}).step(fmt::format("{:.2f} dB", now.psnr_db));
}

void TerminalObserver::on_frames_scored(std::int64_t frames) {
  for (; scored_ < frames; ++scored_) bar("frames scored", frames_).step("");
}

void TerminalObserver::on_calibration_frame() { bar("frames to calibrate by", frames_).step(""); }

}  // namespace sgs::app
