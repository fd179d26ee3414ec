// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/live_feed.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <new>

namespace sgs::slam {
namespace {

/// `count` tiny frames, `period_s` apart, the third of them bad.
class FakeSource : public dataset::FrameSource {
 public:
  FakeSource(int count, double period_s) : count_(count), period_s_(period_s) {}
  std::string name() const override { return "fake"; }
  PinholeCamera camera() const override { return {2, 2, 1, 1, 0.5, 0.5}; }
  std::optional<std::int64_t> size() const override { return count_; }
  const Trajectory& ground_truth() const override { return truth_; }
  dataset::FrameRead next(RgbdFrame& frame, Error& error) override {
    if (next_ == count_) return dataset::FrameRead::kEnd;
    frame = {};
    frame.index = next_;
    frame.timestamp_s = period_s_ * next_;
    frame.camera = camera();
    frame.color = ColorImage(2, 2);
    frame.depth = DepthImage(2, 2);
    if (next_++ == 2) {
      error = {ErrorCode::kInvalidFormat, "frame 2 is broken", ""};
      return dataset::FrameRead::kBadFrame;
    }
    return dataset::FrameRead::kOk;
  }

 private:
  int count_;
  double period_s_;
  int next_ = 0;
  Trajectory truth_;
};

TEST(LiveFeed, DeliversEverythingInOrderToAPromptReader) {
  FakeSource source(5, 0.002);
  LiveFeed feed(source, 8);
  for (int i = 0; i < 5; ++i) {
    const auto item = feed.next();
    ASSERT_TRUE(item);
    EXPECT_EQ(item->index, i);
    EXPECT_EQ(item->frame == nullptr, i == 2);
    EXPECT_EQ(item->bad_reason.empty(), i != 2);
  }
  EXPECT_FALSE(feed.next());
  EXPECT_EQ(feed.dropped(), 0u);
}

TEST(LiveFeed, WhatTheSourceThrowsComesAfterTheFramesBeforeIt) {
  class Broken : public FakeSource {
   public:
    Broken() : FakeSource(5, 0.002) {}
    dataset::FrameRead next(RgbdFrame& frame, Error& error) override {
      if (++calls_ == 3) throw std::bad_alloc();
      return FakeSource::next(frame, error);
    }

   private:
    int calls_ = 0;
  } source;
  LiveFeed feed(source, 8);
  EXPECT_EQ(feed.next()->index, 0);
  EXPECT_EQ(feed.next()->index, 1);
  EXPECT_THROW(feed.next(), std::bad_alloc);
  EXPECT_FALSE(feed.next());
}

TEST(LiveFeed, DropsTheOldestAndCountsThem) {
  FakeSource source(20, 0.0005);
  LiveFeed feed(source, 2);
  // Without a reader only the newest two survive.
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  while (feed.dropped() < 18) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(feed.next()->index, 18);
  EXPECT_EQ(feed.next()->index, 19);
  EXPECT_FALSE(feed.next());
}

TEST(LiveFeed, WhileItIsHeldFramesAreLeftOutAndNotCountedAsDropped) {
  constexpr int kFrames = 4000;
  FakeSource source(kFrames, 0.001);
  std::atomic<std::size_t> seen{0};
  LiveFeed feed(source, 2, [&](const dataset::FeedItem&) { ++seen; });
  ASSERT_TRUE(feed.next());
  feed.hold();
  feed.hold();  // once more changes nothing
  const std::size_t delivered = feed.delivered();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_LE(feed.delivered(), delivered + 1) << "but for one that was under way";
  const std::size_t dropped = feed.dropped();
  const std::size_t left_out = feed.release();
  EXPECT_GT(left_out, 0u);
  const auto item = feed.next();
  ASSERT_TRUE(item);
  EXPECT_LE(feed.dropped(), dropped + feed.delivered() - delivered);
  EXPECT_EQ(feed.release(), 0u);
  feed.stop();
  EXPECT_LE(feed.delivered(), seen + 1);
}

TEST(LiveFeed, StopsInTheMiddleOfALongGap) {
  FakeSource source(3, 9);  // longer ones are not waited for
  LiveFeed feed(source, 2);
  EXPECT_EQ(feed.next()->index, 0);
  feed.stop();
  EXPECT_FALSE(feed.next());
}

TEST(ReadItem, PassesBadFramesOn) {
  FakeSource source(3, 1);
  EXPECT_TRUE(dataset::read_item(source)->frame);
  EXPECT_TRUE(dataset::read_item(source)->frame);
  EXPECT_EQ(dataset::read_item(source)->bad_reason, "frame 2 is broken");
  EXPECT_FALSE(dataset::read_item(source));
}

}  // namespace
}  // namespace sgs::slam
