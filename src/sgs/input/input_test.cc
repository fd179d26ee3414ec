// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/input/input.h"

#include <gmock/gmock.h>

namespace sgs::run {
namespace {

TEST(FrameRange, IsHalfOpenWithOpenEnds) {
  EXPECT_EQ(parse_frame_range("")->first, 0);
  EXPECT_EQ(parse_frame_range("3:7")->first, 3);
  EXPECT_EQ(parse_frame_range("3:7")->last, 7);
  EXPECT_EQ(parse_frame_range("3:")->first, 3);
  EXPECT_EQ(parse_frame_range(":7")->last, 7);
  for (const char* text : {"7", "7:3", "3:3", "a:b", "-1:3", "1:2:3"}) {
    EXPECT_FALSE(parse_frame_range(text)) << text;
  }
}

TEST(Input, ARangeOfASyntheticSequenceIsNumberedFromZero) {
  InputSpec spec;
  spec.input = "synth:room_desk";
  spec.frames = "2:4";
  auto input = open_input(spec, 1);
  ASSERT_TRUE(input);
  EXPECT_EQ(input->info.frames, 2);
  RgbdFrame frame;
  Error error;
  ASSERT_EQ(input->source->next(frame, error), dataset::FrameRead::kOk);
  EXPECT_EQ(frame.index, 0);
  ASSERT_EQ(input->source->next(frame, error), dataset::FrameRead::kOk);
  EXPECT_EQ(frame.index, 1);
  EXPECT_EQ(input->source->next(frame, error), dataset::FrameRead::kEnd);
}

TEST(Input, OptionsThatDoNotApplyAreRefused) {
  InputSpec spec;
  spec.input = "synth:room_desk";
  spec.camera = "1,1,1,1";
  EXPECT_FALSE(open_input(spec, 1));
  spec.camera = "";
  spec.frames = "99999:";
  EXPECT_FALSE(open_input(spec, 1));
  InputSpec folder;
  folder.input = "/no/such/folder";
  EXPECT_FALSE(open_input(folder, 1));
}

}  // namespace
}  // namespace sgs::run
