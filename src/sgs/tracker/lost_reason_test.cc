// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/lost_reason.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/tracker/test_tracker.h"
#include "sgs/tracker/tracker.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {
namespace {

TrackerConfig config_of(TrackerType type) {
  TrackerConfig config = type == TrackerType::kPaper ? paper_tracker_config() : TrackerConfig{};
  config.type = type;
  config.orb.features = 400;
  return config;
}

// Tracks the frames with a fresh tracker and returns what became of the last one.
TrackResult track_all(const TrackerConfig& config, const std::vector<RgbdFrame>& frames) {
  const auto tracker = must_make(config, alignment::kWallCamera, SE3{});
  TrackResult last;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    last = tracker->track(frames[i], nullptr);
    EXPECT_EQ(last.status == TrackingStatus::kLost,
              last.lost_reason != alignment::LostReason::kNone);
    if (i + 1 < frames.size()) {
      EXPECT_EQ(last.lost_reason, alignment::LostReason::kNone) << to_string(last.lost_reason);
    }
  }
  return last;
}

SE3 shifted(double x, double z = 0) { return SE3(Eigen::Matrix3d::Identity(), {x, 0, z}); }

RgbdFrame without_depth(RgbdFrame frame) {
  frame.depth.fill(0);
  return frame;
}

// Depth in a corner only.
RgbdFrame with_little_depth(RgbdFrame frame) {
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 0; u < frame.depth.width(); ++u) {
      if (u > 40 || v > 40) frame.depth(u, v) = 0;
    }
  }
  return frame;
}

// Vertical stripes: nothing in the picture changes when the camera moves up or down.
RgbdFrame striped(int index) {
  RgbdFrame frame = alignment::see_wall(SE3{}, index);
  for (int v = 0; v < frame.color.height(); ++v) {
    for (int u = 0; u < frame.color.width(); ++u) {
      const auto grey = static_cast<std::uint8_t>((u / 8) % 2 == 0 ? 60 : 180);
      frame.color(u, v) = {grey, grey, grey};
    }
  }
  return frame;
}

class ByRegistration : public testing::TestWithParam<TrackerType> {};

TEST_P(ByRegistration, NoDepth) {
  EXPECT_EQ(
      track_all(config_of(GetParam()), {without_depth(alignment::see_wall(SE3{}, 0))}).lost_reason,
      alignment::LostReason::kNoDepth);
}

TEST_P(ByRegistration, TooFewPoints) {
  EXPECT_EQ(track_all(config_of(GetParam()), {with_little_depth(alignment::see_wall(SE3{}, 0))})
                .lost_reason,
            alignment::LostReason::kTooFewPoints);
}

TEST_P(ByRegistration, TooFewMatches) {
  // Half a metre nearer from one frame to the next: beyond the gate of the search.
  EXPECT_EQ(track_all(config_of(GetParam()),
                      {alignment::see_wall(SE3{}, 0), alignment::see_wall(shifted(0, 0.5), 1)})
                .lost_reason,
            alignment::LostReason::kTooFewMatches);
}

TEST_P(ByRegistration, ImplausibleMotion) {
  TrackerConfig config = config_of(GetParam());
  config.motion.max_translation_m = 0.01;
  EXPECT_EQ(
      track_all(config, {alignment::see_wall(SE3{}, 0), alignment::see_wall(shifted(0, 0.015), 1)})
          .lost_reason,
      alignment::LostReason::kImplausibleMotion);
}

INSTANTIATE_TEST_SUITE_P(LostReason, ByRegistration,
                         testing::Values(TrackerType::kSpectral, TrackerType::kPaper,
                                         TrackerType::kGicp),
                         [](const auto& param_info) { return to_string(param_info.param); });

TEST(LostReason, TooFewPixels) {
  // A bare wall: geometry leaves three axes open, and nothing on the wall can be followed.
  EXPECT_EQ(track_all(config_of(TrackerType::kSpectral),
                      {alignment::see_wall(SE3{}, 0, false), alignment::see_wall(SE3{}, 1, false)})
                .lost_reason,
            alignment::LostReason::kTooFewPixels);
}

TEST(LostReason, PoorPictureFit) {
  // The same wall with another paper on it.
  EXPECT_EQ(track_all(config_of(TrackerType::kSpectral),
                      {alignment::see_wall(SE3{}, 0), alignment::see_wall(shifted(50), 1)})
                .lost_reason,
            alignment::LostReason::kPoorPictureFit);
}

TEST(LostReason, UnseenAxis) {
  EXPECT_EQ(track_all(config_of(TrackerType::kSpectral), {striped(0), striped(1)}).lost_reason,
            alignment::LostReason::kUnseenAxis);
}

TEST(LostReason, TooFewFeatures) {
  EXPECT_EQ(track_all(config_of(TrackerType::kOrb),
                      {alignment::see_wall(SE3{}, 0), alignment::see_wall(SE3{}, 1, false)})
                .lost_reason,
            alignment::LostReason::kTooFewFeatures);
}

TEST(LostReason, TooFewFeatureMatches) {
  TrackerConfig config = config_of(TrackerType::kOrb);
  config.visual_pose.max_depth_m = 1;  // the wall is farther: no point of it may be matched to
  EXPECT_EQ(
      track_all(config, {alignment::see_wall(SE3{}, 0), alignment::see_wall(SE3{}, 1)}).lost_reason,
      alignment::LostReason::kTooFewFeatureMatches);
}

TEST(LostReason, TooFewFeatureInliers) {
  // Descriptors on another paper find partners, but these agree on nothing.
  EXPECT_EQ(track_all(config_of(TrackerType::kOrb),
                      {alignment::see_wall(SE3{}, 0), alignment::see_wall(shifted(50), 1)})
                .lost_reason,
            alignment::LostReason::kTooFewFeatureInliers);
}

TEST(LostReason, ImplausibleMotionOfFeatures) {
  TrackerConfig config = config_of(TrackerType::kOrb);
  config.motion.max_translation_m = config.visual_pose.max_translation_m = 0.01;
  EXPECT_EQ(
      track_all(config, {alignment::see_wall(SE3{}, 0), alignment::see_wall(shifted(0.04), 1)})
          .lost_reason,
      alignment::LostReason::kImplausibleMotion);
}

TEST(LostReason, NotFinite) {
  for (const TrackerType type : {TrackerType::kGicp, TrackerType::kCvm}) {
    std::vector<RgbdFrame> frames = {alignment::see_wall(SE3{}, 0), alignment::see_wall(SE3{}, 1),
                                     alignment::see_wall(SE3{}, 2)};
    frames[2].timestamp_s = std::numeric_limits<double>::quiet_NaN();
    const TrackResult r = track_all(config_of(type), frames);
    EXPECT_EQ(r.lost_reason, alignment::LostReason::kNotFinite) << to_string(type);
    EXPECT_TRUE(r.T_odom_camera.all_finite());
  }
}

TEST(LostReason, EachHasANameAndASentenceOfItsOwn) {
  std::set<std::string_view> names, sentences;
  for (const alignment::LostReasonEntry& entry : alignment::kLostReasons) {
    names.insert(entry.name);
    sentences.insert(entry.sentence);
    EXPECT_EQ(to_string(entry.reason), entry.name);
    EXPECT_EQ(alignment::explain(entry.reason), entry.sentence);
    EXPECT_EQ(entry.sentence.back(), '.') << entry.name;
  }
  EXPECT_EQ(names.size(), alignment::kLostReasons.size());
  EXPECT_EQ(sentences.size(), alignment::kLostReasons.size());
}

}  // namespace
}  // namespace sgs::tracker
