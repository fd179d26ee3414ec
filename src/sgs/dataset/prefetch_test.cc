// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/prefetch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

namespace sgs::dataset {
namespace {

/// Counts up; every third frame is bad; throws at frame `throw_at`.
class CountingSource : public FrameSource {
 public:
  CountingSource(std::int64_t frames, std::int64_t throw_at, std::atomic<int>& reads)
      : frames_(frames), throw_at_(throw_at), reads_(reads) {}
  std::string name() const override { return "counting"; }
  PinholeCamera camera() const override { return {4, 3, 1, 1, 0, 0}; }
  std::optional<std::int64_t> size() const override { return frames_; }
  const Trajectory& ground_truth() const override { return truth_; }
  FrameRead next(RgbdFrame& frame, Error& error) override {
    if (at_ == throw_at_) throw std::runtime_error("source broke");
    if (at_ == frames_) return FrameRead::kEnd;
    ++reads_;
    frame = RgbdFrame{};
    frame.index = at_++;
    if (frame.index % 3 != 2) return FrameRead::kOk;
    error = {ErrorCode::kIo, "bad " + std::to_string(frame.index), ""};
    return FrameRead::kBadFrame;
  }

 private:
  std::int64_t frames_, throw_at_, at_ = 0;
  std::atomic<int>& reads_;
  Trajectory truth_;
};

TEST(Prefetch, PassesEverythingThroughInOrder) {
  for (const std::size_t depth : {1u, 8u, 100u}) {
    std::atomic<int> reads{0};
    PrefetchingSource source(std::make_unique<CountingSource>(50, -1, reads), depth);
    EXPECT_EQ(source.name(), "counting");
    EXPECT_EQ(source.size(), 50);
    EXPECT_EQ(source.camera().width, 4);
    RgbdFrame frame;
    Error error;
    for (int i = 0; i < 50; ++i) {
      const FrameRead read = source.next(frame, error);
      EXPECT_EQ(frame.index, i);
      EXPECT_EQ(read, i % 3 == 2 ? FrameRead::kBadFrame : FrameRead::kOk);
      if (i % 3 == 2) {
        EXPECT_EQ(error.message, "bad " + std::to_string(i));
      }
    }
    EXPECT_EQ(source.next(frame, error), FrameRead::kEnd);
    EXPECT_EQ(source.next(frame, error), FrameRead::kEnd);
  }
}

TEST(Prefetch, StopsEarlyAndHoldsABoundedNumberOfFrames) {
  std::atomic<int> reads{0};
  {
    PrefetchingSource source(std::make_unique<CountingSource>(1'000'000, -1, reads), 4);
    RgbdFrame frame;
    Error error;
    for (int i = 0; i < 10; ++i) source.next(frame, error);
    EXPECT_LE(reads, 10 + 4 + 1);
    source.stop();
    int rest = 0;
    while (source.next(frame, error) != FrameRead::kEnd) ++rest;
    EXPECT_LE(rest, 4);
  }
  EXPECT_LE(reads, 10 + 4 + 1);
  // Never read from at all: the destructor must not wait for a reader.
  const PrefetchingSource unread(std::make_unique<CountingSource>(1'000'000, -1, reads), 2);
}

TEST(Prefetch, RethrowsAtTheRightFrame) {
  std::atomic<int> reads{0};
  PrefetchingSource source(std::make_unique<CountingSource>(9, 2, reads), 4);
  RgbdFrame frame;
  Error error;
  EXPECT_EQ(source.next(frame, error), FrameRead::kOk);
  EXPECT_EQ(source.next(frame, error), FrameRead::kOk);
  EXPECT_THROW(source.next(frame, error), std::runtime_error);
  EXPECT_EQ(source.next(frame, error), FrameRead::kEnd);
}

}  // namespace
}  // namespace sgs::dataset
