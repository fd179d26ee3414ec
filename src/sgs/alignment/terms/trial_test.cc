// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/terms/trial.h"

#include <gtest/gtest.h>

namespace sgs::alignment {
namespace {

TEST(Trial, WhatStaysLongEnoughHasStayed) {
  Trial trial(1);
  const Eigen::Vector3f point(-0.31f, 2.02f, 1.01f), elsewhere(0.5f, 2.02f, 1.01f);
  for (int i = 0; i <= 9; ++i) trial.see(point, 0.1 * i);
  EXPECT_FALSE(trial.stayed(point, 0.95));
  trial.see(point, 1.0);
  EXPECT_TRUE(trial.stayed(point, 1.05));
  EXPECT_FALSE(trial.stayed(elsewhere, 1.05));
}

TEST(Trial, WhatWasAwayIsNew) {
  Trial trial(1);
  const Eigen::Vector3f point(1, 1, 1);
  for (int i = 0; i <= 20; ++i) trial.see(point, 0.1 * i);
  EXPECT_TRUE(trial.stayed(point, 2.1));
  EXPECT_FALSE(trial.stayed(point, 3.0)) << "not seen lately";
  trial.see(point, 3.0);
  EXPECT_FALSE(trial.stayed(point, 3.0));
}

TEST(Trial, ForgettingKeepsWhatIsSeen) {
  Trial trial(1);
  const Eigen::Vector3f point(1, 1, 1), gone(2, 1, 1);
  for (int i = 0; i <= 20; ++i) {
    trial.see(point, 0.1 * i);
    if (i < 5) trial.see(gone, 0.1 * i);
    trial.forget(0.1 * i);
  }
  EXPECT_TRUE(trial.stayed(point, 2.0));
  EXPECT_FALSE(trial.stayed(gone, 2.0));
}

}  // namespace
}  // namespace sgs::alignment
