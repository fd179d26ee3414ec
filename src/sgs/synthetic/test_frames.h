// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
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
  EXPECT_EQ(static_cast<std::int64_t>(frames.size()), *(*source)->size());
  return frames;
}

}  // namespace sgs::synthetic
