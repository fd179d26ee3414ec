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

TEST(TimeUnit, TicksAreNoNanoseconds) {
  std::vector<double> file_times, net_ticks, nanoseconds;
  for (int i = 0; i < 20; ++i) {
    file_times.push_back(1.33e17 + 333'333.0 * i);
    net_ticks.push_back(6.38e17 + 333'333.0 * i);
    nanoseconds.push_back(1.7e18 + 33'333'333.0 * i);
  }
  EXPECT_EQ(unit_of_times(file_times, true).per_second, 1e7);
  EXPECT_EQ(unit_of_times(net_ticks, true).per_second, 1e7);
  EXPECT_EQ(unit_of_times(nanoseconds, true).per_second, 1e9);
}

TEST(TimeUnit, StepsOfACameraAreEven) {
  std::vector<double> even, uneven;
  for (int i = 0; i < 20; ++i) {
    even.push_back(33.3 * i + (i > 15 ? 500 : 0));
    uneven.push_back(i * i);
  }
  EXPECT_TRUE(steps_evenly(even));
  EXPECT_FALSE(steps_evenly(uneven));
  EXPECT_FALSE(steps_evenly({1, 2, 3}));
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
