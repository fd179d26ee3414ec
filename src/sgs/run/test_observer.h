// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "sgs/run/run_observer.h"

namespace sgs::run {

/// Calls what a test is interested in; each may be empty.
class TestObserver : public RunObserver {
 public:
  std::function<void(const slam::FrameRecord&)> frame;
  std::function<void(slam::Session&)> map;
  std::function<void(std::int64_t)> frames_scored;
  std::function<void(const refine::Evaluation&)> evaluation;

  void on_frame(slam::Session&, const dataset::FeedItem&,
                const slam::FrameRecord& record) override {
    if (frame) frame(record);
  }
  void on_map(slam::Session& session) override {
    if (map) map(session);
  }
  void on_frames_scored(std::int64_t frames) override {
    if (frames_scored) frames_scored(frames);
  }
  void on_evaluation(const refine::Evaluation& now) override {
    if (evaluation) evaluation(now);
  }
};

}  // namespace sgs::run
