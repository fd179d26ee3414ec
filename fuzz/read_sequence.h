// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "harness.h"
#include "sgs/dataset/open.h"

namespace sgs::fuzz {

/// Reads the first frames of a folder, if it can be opened at all, with the poses asked for.
inline void read_sequence(const std::filesystem::path& folder, const std::string& poses = {}) {
  dataset::OpenOptions options;
  options.prefetch = 0;
  options.poses = poses;
  const auto sequence = dataset::open_sequence(folder, options);
  if (!sequence) return;
  RgbdFrame frame;
  Error error;
  std::int64_t last = -1;
  for (int i = 0; i < 10; ++i) {
    const auto read = sequence->frames->next(frame, error);
    if (read == dataset::FrameRead::kEnd) break;
    if (read != dataset::FrameRead::kOk) continue;
    require(frame.index > last, "frames come in order");
    require(poses.empty() || frame.given_T_world_camera->all_finite(), "poses are finite");
    last = frame.index;
  }
}

}  // namespace sgs::fuzz
