// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/time_unit.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgs::dataset {
namespace {

/// Times of 30 images a second, begun at `start_s`, in a unit.
std::vector<double> times(double start_s, double per_second) {
  std::vector<double> t;
  for (int i = 0; i < 20; ++i) t.push_back(std::floor((start_s + i / 30.0) * per_second));
  return t;
}

TEST(TimeUnit, IsRecognisedByTheSizeOfTimesSince1970) {
  for (const double per_second : {1e3, 1e6, 1e9}) {
    for (const bool whole : {true, false}) {
      const TimeUnit unit = unit_of_times(times(1.7e9, per_second), whole);
      EXPECT_EQ(unit.per_second, per_second);
      EXPECT_TRUE(unit.known);
      EXPECT_FALSE(unit.name.empty());
    }
  }
}

TEST(TimeUnit, IsRecognisedByTheStepsOfACameraThatCountsFromItsStart) {
  for (const double per_second : {1e3, 1e6, 1e9}) {
    EXPECT_EQ(unit_of_times(times(12, per_second), true).per_second, per_second);
  }
  // As many nanoseconds since a start as milliseconds since 1970.
  EXPECT_EQ(unit_of_times(times(123, 1e9), true).per_second, 1e9);
}

TEST(TimeUnit, SecondsStayWhatTheyAre) {
  std::vector<double> fractions, views, dates;
  for (int i = 0; i < 20; ++i) {
    fractions.push_back(1305031098.6659 + i / 30.0);
    views.push_back(10.5 * i);             // single views, with fractions
    dates.push_back(1'700'000'000.0 + i);  // one image a second, since 1970
  }
  EXPECT_TRUE(unit_of_times(fractions, false).name.empty());
  EXPECT_TRUE(unit_of_times(views, false).name.empty());
  EXPECT_TRUE(unit_of_times(dates, true).name.empty());
  EXPECT_TRUE(unit_of_times({}, true).name.empty());
  EXPECT_TRUE(unit_of_times({1, 1, 1, 1}, true).name.empty());
}

TEST(TimeUnit, NumbersThatGoByOneCountFrames) {
  std::vector<double> counts;
  for (int i = 1; i < 20; ++i) counts.push_back(i);
  const TimeUnit unit = unit_of_times(counts, true);
  EXPECT_EQ(unit.per_second, 30);
  EXPECT_FALSE(unit.known);
  // Every fifth.
  for (double& count : counts) count *= 5;
  EXPECT_EQ(unit_of_times(counts, true).per_second, 30);
  // Not written as whole numbers: whoever calls knows better.
  EXPECT_TRUE(unit_of_times(counts, false).name.empty());
}

}  // namespace
}  // namespace sgs::dataset
