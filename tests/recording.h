// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "sgs/dataset/feed_item.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/synthetic/source.h"

namespace sgs {

/// A short rendered sequence in memory, with its truth.
struct Recording {
  std::vector<std::shared_ptr<const RgbdFrame>> frames;
  Trajectory truth;
  PinholeCamera camera;
};

inline Recording record(const synthetic::SynthOptions& options) {
  auto source = synthetic::make_synthetic_source(options);
  EXPECT_TRUE(source) << source.error().text();
  Recording out;
  out.truth = (*source)->ground_truth();
  out.camera = options.camera;
  while (auto item = dataset::read_item(**source)) out.frames.push_back(item->frame);
  return out;
}

/// Root mean square error of a path after alignment, metres.
inline double ate_m(const Trajectory& poses, const Trajectory& truth) {
  return eval::evaluate_trajectory(eval::to_estimates(poses), truth).ate->rmse;
}

}  // namespace sgs
