// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/frame_record.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

namespace sgs::slam {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

FrameRecord full_record() {
  FrameRecord r;
  r.index = 7;
  r.timestamp_s = 1305031102.175304;
  r.status = tracker::TrackingStatus::kLost;
  r.lost_reason = alignment::LostReason::kTooFewMatches;
  r.mapping_keyframe = true;
  r.track_ms = 4.25;
  r.gaussians = 12345;
  r.diagnostics.inliers = 99;
  r.diagnostics.overlap = 0.5;
  r.diagnostics.degenerate_mask = 5;
  r.diagnostics.prior_source = tracker::PriorSource::kPhotometric;
  r.diagnostics.snr = {1, 2, 3, 4, 5, 6};
  r.diagnostics.axes = Matrix6d::Identity();
  (*r.diagnostics.axes)(2, 3) = 0.25;
  return r;
}

// Names and order are an interface: files of older versions are read, and other programs read ours.
TEST(FrameRecord, HeaderKeepsItsColumns) {
  EXPECT_THAT(
      frames_csv_header(),
      StartsWith("index,timestamp_s,status,tracking_keyframe,mapping_keyframe,heldout,track_ms,"
                 "gaussians,mapping_iterations,source_points,inliers,visual_inliers,overlap,cost,"
                 "visual_cost,readout_s,tracking_iterations,condition_number,planarity,"
                 "prior_source,prior_active,degenerate_mask,eigenvalue_0,eigenvalue_1,eigenvalue_2,"
                 "eigenvalue_3,eigenvalue_4,eigenvalue_5,snr_0,"));
  EXPECT_THAT(frames_csv_header(), HasSubstr("weight_5,ms_points,ms_index,ms_geometry,ms_visual,"
                                             "ms_update,axis_0_0,axis_0_1,"));
  EXPECT_THAT(frames_csv_header(), HasSubstr("axis_5_5,lost_reason,targets"));
}

TEST(FrameRecord, WrittenAndReadBackIsTheSame) {
  FrameRecord bad;
  bad.index = 9;
  bad.timestamp_s = 1305031103;
  bad.bad = true;
  const std::vector<FrameRecord> records = {full_record(), bad};
  const std::string text = frames_csv(records);
  const auto back = frames_from_csv(text, "frames.csv");
  ASSERT_TRUE(back) << back.error().text();
  ASSERT_EQ(back->size(), 2u);
  EXPECT_EQ(frames_csv(*back), text);
  const FrameRecord& r = back->front();
  EXPECT_EQ(r.index, 7);
  EXPECT_EQ(r.lost_reason, alignment::LostReason::kTooFewMatches);
  EXPECT_EQ(r.diagnostics.prior_source, tracker::PriorSource::kPhotometric);
  EXPECT_EQ(r.diagnostics.axes, records[0].diagnostics.axes);
  EXPECT_TRUE(std::isnan(r.diagnostics.cost)) << "what was not measured stays so";
  EXPECT_TRUE(back->back().bad);
}

TEST(FrameRecord, EveryLineHasACellPerColumn) {
  const auto cells = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  EXPECT_EQ(cells(frames_csv_line(full_record())), cells(frames_csv_header()));
  EXPECT_EQ(cells(frames_csv_line({})), cells(frames_csv_header()));
}

TEST(FrameRecord, OlderAndNewerFilesAreRead) {
  const auto older = frames_from_csv("index,timestamp_s,status\n0,0.5,ok\n", "f");
  ASSERT_TRUE(older);
  EXPECT_EQ(older->at(0).status, tracker::TrackingStatus::kOk);
  EXPECT_TRUE(frames_from_csv("index,timestamp_s,status,mood\n0,0.5,ok,9\n", "f"));
}

TEST(FrameRecord, DamagedFilesAreErrorsThatNameLineAndColumn) {
  const std::string head = "index,timestamp_s,status,overlap\n";
  for (const auto& [rows, expected] : std::vector<std::pair<std::string, std::string>>{
           {"0,0.5,ok,x\n", "f: line 2: 'x' in column 'overlap'"},
           {"0,0.5,fine,1\n", "f: line 2: 'fine' in column 'status'"},
           {"1,0.5,ok,1\n1,0.6,ok,1\n", "f: line 3: '1' in column 'index'"},
           {"-1,0.5,ok,1\n", "line 2"},
           {"10000000000,0.5,ok,1\n", "line 2"},
           {"0,0.5,ok,1,2\n", "line 2 has 5 cells"}}) {
    const auto read = frames_from_csv(head + rows, "f");
    ASSERT_FALSE(read) << rows;
    EXPECT_THAT(read.error().message, HasSubstr(expected));
  }
  EXPECT_FALSE(frames_from_csv("", "f"));
}

TEST(FrameRecord, ColumnsAreDeclaredWhole) {
  std::set<std::string_view> keys;
  const FrameRecord any;
  visit_columns(any, [&](const FrameColumn& c, const auto&) {
    EXPECT_TRUE(keys.insert(c.key).second) << c.key;
    EXPECT_TRUE(c.meaning.ends_with(".")) << c.key;
    EXPECT_THAT(frame_columns_markdown(), HasSubstr(fmt::format("`{}", c.key)));
  });
}

}  // namespace
}  // namespace sgs::slam
