// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/api/map.h"
#include "sgs/api/recording.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/input/input.h"
#include "sgs/map/gaussian.h"

namespace sgs::api::internal {

/// How the parts of the library see what lies behind each other's handles.
struct FrameAccess {
  static Frame make(std::shared_ptr<const RgbdFrame> frame);
  static std::shared_ptr<const RgbdFrame> get(const Frame& frame);
};

struct RecordingAccess {
  static const run::Input& input(const Recording& recording);
  static const run::InputSpec& spec(const Recording& recording);
};

struct MapAccess {
  static Map make(map::SnapshotPtr snapshot);
};

/// What `input` and `options` of Recording::open() ask for; throws as it does.
run::InputSpec input_spec(const std::string& input, const Settings& options);

}  // namespace sgs::api::internal
