// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/frame_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "sgs/dataset/feed_item.h"
#include "sgs/dataset/open.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr PinholeCamera kTinyCamera{16, 12, 14, 14, 7.5, 5.5};
constexpr std::uintmax_t kGiB = std::uintmax_t{1} << 30;

std::shared_ptr<const RgbdFrame> frame(int index) {
  auto out = std::make_shared<RgbdFrame>();
  out->index = index;
  out->timestamp_s = 10.0 + index / 30.0;
  out->camera = kTinyCamera;
  out->color = ColorImage(16, 12, {static_cast<std::uint8_t>(index), 7, 9});
  out->depth = DepthImage(16, 12, static_cast<float>(1024 + index) / 1024);
  return out;
}

FrameRecorder::Options options() {
  FrameRecorder::Options options;
  options.camera = kTinyCamera;
  options.writer.depth_scale = 1024;  // exact in floats
  options.free_bytes = [](const fs::path&) { return 100 * kGiB; };
  return options;
}

TEST(FrameRecorder, KeepsWhatItIsOfferedWhileItIsOn) {
  const io::TemporaryFolder temp;
  FrameRecorder recorder(options());
  recorder.offer(frame(0));
  ASSERT_TRUE(recorder.start(temp.path() / "kept"));
  ASSERT_TRUE(recorder.start(temp.path() / "other")) << "there is one already";
  for (int i = 1; i < 40; ++i) recorder.offer(frame(i));
  recorder.stop();
  recorder.stop();
  recorder.offer(frame(40));
  EXPECT_FALSE(fs::exists(temp.path() / "other"));
  const RecordingStatus status = recorder.status();
  EXPECT_FALSE(status.on);
  EXPECT_EQ(status.frames, 39);
  EXPECT_EQ(status.trouble, "");
  EXPECT_TRUE(recorder.failure());

  auto opened = dataset::open_sequence((temp.path() / "kept").string(), {});
  ASSERT_TRUE(opened) << opened.error().text();
  for (int i = 1; i < 40; ++i) {
    const auto item = dataset::read_item(*opened->frames);
    ASSERT_TRUE(item && item->frame);
    EXPECT_EQ(item->timestamp_s, frame(i)->timestamp_s) << "to the last bit";
    EXPECT_EQ(item->frame->color(3, 3), frame(i)->color(3, 3));
    EXPECT_EQ(item->frame->depth(3, 3), frame(i)->depth(3, 3));
  }
  EXPECT_FALSE(dataset::read_item(*opened->frames));
}

TEST(FrameRecorder, AFullDiskIsToldAtTheBeginning) {
  const io::TemporaryFolder temp;
  auto full = options();
  full.free_bytes = [](const fs::path&) { return std::uintmax_t{1000}; };
  FrameRecorder recorder(full);
  const Status begun = recorder.start(temp.path() / "kept");
  ASSERT_FALSE(begun);
  EXPECT_THAT(begun.error().message, HasSubstr("nearly full"));
  EXPECT_THAT(recorder.status().trouble, HasSubstr("nearly full"));
  recorder.offer(frame(0));
  EXPECT_FALSE(fs::exists(temp.path() / "kept"));
}

TEST(FrameRecorder, ADiskThatFillsEndsTheRecordingAndWhatIsThereIsWhole) {
  const io::TemporaryFolder temp;
  std::atomic<std::uintmax_t> free = 2 * kGiB;
  auto filling = options();
  filling.free_bytes = [&](const fs::path&) { return free.load(); };
  FrameRecorder recorder(filling);
  ASSERT_TRUE(recorder.start(temp.path() / "kept"));
  int index = 0;
  while (recorder.status().frames == 0) recorder.offer(frame(index++));
  free = 0;
  while (recorder.status().on) recorder.offer(frame(index++));
  EXPECT_THAT(recorder.status().trouble, HasSubstr("nearly full"));
  EXPECT_FALSE(recorder.failure());
  recorder.offer(frame(index));
  auto opened = dataset::open_sequence((temp.path() / "kept").string(), {});
  ASSERT_TRUE(opened) << opened.error().text();
  EXPECT_EQ(opened->frames->size(), recorder.status().frames);
  // Room again: another one.
  free = 2 * kGiB;
  ASSERT_TRUE(recorder.start(temp.path() / "more"));
  EXPECT_EQ(recorder.status().trouble, "");
}

TEST(FrameRecorder, AFolderInUseIsAnError) {
  const io::TemporaryFolder temp;
  FrameRecorder recorder(options());
  ASSERT_TRUE(recorder.start(temp.path() / "kept"));
  recorder.offer(frame(0));
  recorder.stop();
  EXPECT_FALSE(recorder.start(temp.path() / "kept"));
  EXPECT_THAT(recorder.status().trouble, HasSubstr("not empty"));
}

TEST(DiskWatch, SaysInTimeThatADiskFills) {
  constexpr double kRate = 50e6;  // bytes a second
  DiskWatch watch(kGiB / 2);
  double free = 60e9;
  auto room = DiskWatch::Room::kEnough;
  double low_at_s = -1, none_at_s = -1;
  for (int s = 0; s < 1400 && none_at_s < 0; ++s, free -= kRate) {
    room = watch.look(s, static_cast<std::uintmax_t>(free));
    if (room == DiskWatch::Room::kLow && low_at_s < 0) low_at_s = s;
    if (room == DiskWatch::Room::kNone) none_at_s = s;
  }
  EXPECT_GT(none_at_s, 0);
  EXPECT_NEAR(none_at_s - low_at_s, 300, 10);
  EXPECT_GE(free, 0.4 * kGiB);
}

TEST(DiskWatch, ADiskThatDoesNotFillIsNoTrouble) {
  DiskWatch watch(kGiB / 2);
  for (int s = 0; s < 100; ++s) EXPECT_EQ(watch.look(s, kGiB), DiskWatch::Room::kEnough);
  EXPECT_FALSE(watch.seconds_left());
}

}  // namespace
}  // namespace sgs::run
