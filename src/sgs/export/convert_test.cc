// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::run {
namespace {

using testing::HasSubstr;

Input open(const std::string& what) {
  InputSpec spec;
  spec.input = what;
  if (what.starts_with("synth:")) spec.frames = "0:4";
  return std::move(*open_input(spec, 1));
}

std::vector<RgbdFrame> frames_of(Input input) {
  std::vector<RgbdFrame> frames;
  Error error;
  for (RgbdFrame frame; input.source->next(frame, error) == dataset::FrameRead::kOk;) {
    frames.push_back(frame);
  }
  return frames;
}

template <class T>
bool same_pixels(const Image<T>& a, const Image<T>& b) {
  return a.size() == b.size() && std::equal(a.data(), a.data() + a.size(), b.data());
}

TEST(Convert, KeepsColourTimesAndWhatSixteenBitsHoldOfDepth) {
  const io::TemporaryFolder temporary;
  Input synthetic = open("synth:room_desk");
  const auto done = convert(synthetic, temporary / "first", false, {}, {});
  ASSERT_TRUE(done) << done.error().text();
  EXPECT_EQ(done->frames, 4);
  EXPECT_EQ(done->bad, 0);
  EXPECT_FALSE(done->stopped);
  const auto original = frames_of(open("synth:room_desk"));
  const auto first = frames_of(open((temporary / "first").string()));
  Input again = open((temporary / "first").string());
  ASSERT_TRUE(convert(again, temporary / "second", false, {}, {}));
  const auto second = frames_of(open((temporary / "second").string()));
  ASSERT_EQ(first.size(), 4u);
  ASSERT_EQ(second.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(first[i].timestamp_s, original[i].timestamp_s);
    EXPECT_EQ(first[i].camera, original[i].camera);
    EXPECT_TRUE(same_pixels(first[i].color, original[i].color));
    EXPECT_NEAR(first[i].depth(320, 240), original[i].depth(320, 240), 1e-4);
    EXPECT_EQ(second[i].timestamp_s, original[i].timestamp_s);
    EXPECT_TRUE(same_pixels(second[i].depth, first[i].depth));
    ASSERT_TRUE(second[i].truth_T_world_camera);
    EXPECT_TRUE(
        second[i].truth_T_world_camera->t.isApprox(original[i].truth_T_world_camera->t, 1e-7));
  }
}

TEST(Convert, KeepsTheUnitsOfTheInput) {
  const io::TemporaryFolder temporary;
  Input synthetic = open("synth:room_desk");
  synthetic.info.calibration.depth_scale = 1000;
  ASSERT_TRUE(convert(synthetic, temporary / "mm", false, {}, {}));
  EXPECT_EQ(open((temporary / "mm").string()).info.calibration.depth_scale, 1000);
}

TEST(Convert, SaysWhatDoesNotFitIntoSixteenBits) {
  const io::TemporaryFolder temporary;
  Input synthetic = open("synth:room_desk");
  synthetic.info.calibration.depth_scale = 60000;  // up to 1.09 m
  const auto done = convert(synthetic, temporary / "near", false, {}, {});
  ASSERT_TRUE(done);
  EXPECT_GT(done->pixels_far, 1000);
  EXPECT_NEAR(done->farthest_m, 1.0922, 1e-3);
}

TEST(Convert, RefusesToOverwrite) {
  const io::TemporaryFolder temporary;
  ASSERT_TRUE(io::write_file(temporary / "out/notes.txt", "mine"));
  Input synthetic = open("synth:room_desk");
  const auto done = convert(synthetic, temporary / "out", false, {}, {});
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().text(), HasSubstr("not empty"));
  EXPECT_EQ(io::read_file(temporary / "out/notes.txt").value(), "mine");
}

TEST(Convert, AStopLeavesAUsablePart) {
  const io::TemporaryFolder temporary;
  Input synthetic = open("synth:room_desk");
  std::stop_source stop;
  int steps = 0;
  const auto done = convert(
      synthetic, temporary / "part", false,
      [&] {
        if (++steps == 2) stop.request_stop();
      },
      stop.get_token());
  ASSERT_TRUE(done);
  EXPECT_TRUE(done->stopped);
  EXPECT_EQ(done->frames, 2);
  EXPECT_EQ(frames_of(open((temporary / "part").string())).size(), 2u);
}

}  // namespace
}  // namespace sgs::run
