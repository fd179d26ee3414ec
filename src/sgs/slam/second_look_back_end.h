// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sgs/slam/back_end.h"
#include "sgs/tracker/second_look.h"

namespace sgs::slam {

/// Looks again at frames in which something began to move. Frames come as they were tracked.
class SecondLookBackEnd final : public BackEnd {
 public:
  explicit SecondLookBackEnd(const tracker::TrackerConfig& config)
      : look_(tracker::SecondLookConfig(config)) {}

  std::optional<history::Update> add(const std::shared_ptr<const RgbdFrame>& frame,
                                     const tracker::TrackResult& result,
                                     const history::Revision& revision) override;
  /// How often frames were seen to move otherwise.
  int found() const override { return found_; }

 private:
  tracker::SecondLook look_;
  history::CalibrationPtr calibration_;  // of the frames it has
  int found_ = 0;
};

}  // namespace sgs::slam
