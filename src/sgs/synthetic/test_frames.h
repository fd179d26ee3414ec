// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "sgs/synthetic/source.h"

namespace sgs::synthetic {

/// All frames of a sequence.
inline std::vector<RgbdFrame> frames_of(const SynthOptions& options) {
  auto source = make_synthetic_source(options);
  EXPECT_TRUE(source.has_value());
  std::vector<RgbdFrame> frames;
  RgbdFrame frame;
  Error error;
  while ((*source)->next(frame, error) == dataset::FrameRead::kOk) frames.push_back(frame);
  return frames;
}

}  // namespace sgs::synthetic
