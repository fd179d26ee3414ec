// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <stop_token>

#include "sgs/input/input.h"
#include "sgs/slam/session_config.h"
#include "sgs/tracker/track_result.h"

namespace sgs::run {

/// What came of a frame; both empty where the frame could not be read.
using TrackedFrame = std::function<void(const std::shared_ptr<const RgbdFrame>& frame,
                                        const tracker::TrackResult* result)>;

/// Tracks a whole input without building a map. Fails where the tracker needs one, and when a stop
/// is requested.
Status track_only(dataset::FrameSource& source, const slam::SessionConfig& config,
                  const TrackedFrame& after_frame, const std::stop_token& stop = {});

}  // namespace sgs::run
