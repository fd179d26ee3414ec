// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/record_log.h"

#include <gtest/gtest.h>

#include <vector>

namespace sgs::slam {
namespace {

/// A record that differs from others in each kind of field.
FrameRecord record_of(int k) {
  FrameRecord r;
  r.index = 2 * k;
  r.timestamp_s = 0.1 * k;
  r.T_online_camera = SE3::exp(Vector6d::Constant(1e-3 * k));
  if (k % 10 == 7) {
    r.bad = true;
    r.bad_reason = "no depth " + std::to_string(k);
    return r;
  }
  r.status = k % 5 == 0 ? tracker::TrackingStatus::kLost : tracker::TrackingStatus::kDegenerate;
  if (k % 5 == 0) r.lost_reason = alignment::LostReason::kOther;
  r.mapping_keyframe = k % 3 == 0;
  if (k % 2 == 0) r.diagnostics.axes = Matrix6d::Constant(k);
  r.diagnostics.snr[5] = k;
  r.diagnostics.ms_update = 0.5 * k;
  r.track_ms = k;
  r.fingerprint = 1000 + k;
  r.gain[1] = k;
  if (k % 4 == 1) r.movers = std::string("\0\x81", 2);
  return r;
}

std::string text_of(const std::vector<FrameRecord>& records) { return frames_csv(records); }

/// Puts another value into every column.
struct FillColumn {
  int& count;

  template <class T>
  void operator()(const FrameColumn& column, T& field) const {
    const double value = ++count;
    if constexpr (std::is_enum_v<T>) {
      field = enum_names(T{}).back().value;
    } else if constexpr (std::is_same_v<T, bool>) {
      field = true;
    } else if constexpr (std::is_arithmetic_v<T>) {
      field = static_cast<T>(value);
    } else if constexpr (std::is_same_v<T, std::optional<Matrix6d>>) {
      field = Matrix6d::Constant(value);
    } else {
      static_assert(std::is_same_v<T, std::array<double, 6>>, "a column of a new kind");
      field.fill(value);
    }
    EXPECT_FALSE(column.key.empty());
  }
  void operator()(const FrameColumn&, StatusCell<FrameRecord> cell) const {
    cell.record.status = tracker::TrackingStatus::kDegenerate;
  }
};

TEST(RecordLog, EveryColumnComesBackFromTheDisk) {
  int count = 0;
  RecordLog log(testing::TempDir());
  std::vector<FrameRecord> expected;
  for (std::size_t i = 0; i <= RecordLog::kBlock; ++i) {  // the last one pushes the others out
    FrameRecord r;
    visit_columns(r, FillColumn{count});
    r.index = static_cast<std::int64_t>(i);
    expected.push_back(r);
    log.add(r);
  }
  EXPECT_EQ(frames_csv(log.all()), frames_csv(expected));
}

/// Everything that was added, through a log in that folder.
void expect_all(const std::filesystem::path& folder) {
  RecordLog log(folder);
  std::vector<FrameRecord> expected;
  for (int k = 0; k < static_cast<int>(3 * RecordLog::kBlock + 5); ++k) {
    expected.push_back(record_of(k));
    const FrameRecord& added = log.add(record_of(k));
    EXPECT_EQ(&added, &log.back());
    EXPECT_EQ(added.fingerprint, expected.back().fingerprint);
  }
  ASSERT_EQ(log.size(), expected.size());
  const auto records = log.all();
  ASSERT_EQ(records.size(), expected.size());
  EXPECT_EQ(text_of(records), text_of(expected));
  for (std::size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(records[i].bad_reason, expected[i].bad_reason);
    EXPECT_EQ(records[i].movers, expected[i].movers);
    EXPECT_EQ(records[i].T_online_camera.R, expected[i].T_online_camera.R);
    EXPECT_EQ(records[i].T_online_camera.t, expected[i].T_online_camera.t);
    EXPECT_EQ(log.briefs()[i].tracked,
              !expected[i].bad && expected[i].status != tracker::TrackingStatus::kLost);
  }
}

TEST(RecordLog, GivesBackWhatLiesOnTheDisk) { expect_all(testing::TempDir()); }

TEST(RecordLog, KeepsInMemoryWhatNoDiskTakes) { expect_all("/nowhere/at/all"); }

}  // namespace
}  // namespace sgs::slam
