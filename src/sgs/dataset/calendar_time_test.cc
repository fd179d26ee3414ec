// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/calendar_time.h"

#include <gtest/gtest.h>

namespace sgs::dataset {
namespace {

TEST(CalendarTime, IsReadAsPeopleAndProgramsWriteIt) {
  constexpr double kNoon = 1714564800;  // 2024-05-01 12:00:00, UTC
  for (const char* text :
       {"2024-05-01T12:00:00.5", "2024-05-01 12:00:00,500", "2024-05-01T12:00:00.5Z",
        "2024-05-01T12:00:00.5+02:00", "2024/05/01 12:00:00.5", "20240501_120000_500",
        "20240501-120000.5", "2024-05-01-12-00-00.500000", "20240501120000.5"}) {
    const auto time_s = calendar_seconds(text);
    ASSERT_TRUE(time_s) << text;
    EXPECT_NEAR(*time_s, kNoon + 0.5, 1e-6) << text;
  }
  EXPECT_EQ(calendar_seconds("1970-01-01T00:00:00"), 0);
  EXPECT_EQ(calendar_seconds("2024-02-29T00:00:01"),
            calendar_seconds("2024-03-01T00:00:01").value() - 86400);
  EXPECT_NEAR(calendar_seconds("12:00:00.033").value(), 43200.033, 1e-9);
}

TEST(CalendarTime, OtherThingsAreNone) {
  for (const char* text :
       {"", "1", "1700000000.033", "1700000000", "2024", "2024-05-01", "2024-13-01T12:00:00",
        "2024-02-30T12:00:00", "2024-05-01T25:00:00", "2024-05-01T12:00:00.", "12:00",
        "2024-05-01T12:00:00 rgb", "rgb/0.png", "20240501_12000", "1999999999.999999"}) {
    EXPECT_FALSE(calendar_seconds(text)) << text;
  }
}

}  // namespace
}  // namespace sgs::dataset
