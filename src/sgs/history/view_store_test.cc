// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/history/view_store.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <thread>
#include <vector>

#include "sgs/camera/movers.h"
#include "sgs/history/test_spill.h"

namespace sgs::history {
namespace {

const PinholeCamera kCamera{64, 48, 60, 60, 31.5, 23.5};
constexpr std::size_t kBytes = std::size_t{64} * 48 * 5;

RgbdFrame frame_of(std::int64_t index) {
  RgbdFrame frame;
  frame.index = index;
  frame.timestamp_s = 0.1 * static_cast<double>(index);
  frame.camera = kCamera;
  frame.color = ColorImage(kCamera.width, kCamera.height);
  frame.depth = DepthImage(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const auto value = static_cast<std::uint8_t>(3 * u + 5 * v + 7 * index);
      frame.color(u, v) = {value, static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v)};
      frame.depth(u, v) = u == 0 ? 0 : static_cast<float>(25 * u + 5 * v + index) / 5000;
    }
  }
  return frame;
}

bool shows(const StoredView& view, const RgbdFrame& frame) {
  const auto shown = view.frame(nullptr);
  if (!shown) return false;
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    if (shown->depth.data()[i] != frame.depth.data()[i]) return false;
    if (!(shown->color.data()[i] == frame.color.data()[i])) return false;
  }
  return true;
}

std::vector<StoredViewPtr> keep(ViewStore& store, std::int64_t first, std::int64_t count) {
  std::vector<StoredViewPtr> views;
  for (std::int64_t k = first; k < first + count; ++k) {
    views.push_back(store.keep(frame_of(k)));
    store.settle();
  }
  return views;
}

TEST(ViewStore, AFrameIsKeptOnceForAll) {
  ViewStore store(1 << 20, {});
  const auto first = store.keep(frame_of(3));
  EXPECT_EQ(store.keep(frame_of(3)), first);
  EXPECT_NE(store.keep(frame_of(4)), first);
  EXPECT_EQ(first->bytes(), kBytes);
  EXPECT_EQ(store.bytes_in_memory(), kBytes);  // nobody has the other one any more
  EXPECT_EQ(first->index(), 3);
  EXPECT_TRUE(first->camera() == kCamera);
  EXPECT_TRUE(shows(*first, frame_of(3)));
}

TEST(ViewStore, DepthIsKeptAsDeliveredAndCalibratedWhenItIsRead) {
  const auto calibration = [](double offset_per_m) {
    DepthCalibration c;
    c.camera = kCamera;
    c.grid = {2, 2};
    c.offset_per_m.assign(4, offset_per_m);
    return std::make_shared<const DepthCalibration>(c);
  };
  const auto first = calibration(0.02), second = calibration(-0.01);
  const auto raw = std::make_shared<const RgbdFrame>(frame_of(8));
  const auto corrected = copy_to_change(raw);
  corrected->depth = first->apply(raw->depth);
  ViewStore store(1 << 20, {});
  const auto view = store.keep(*corrected, first);
  EXPECT_TRUE(shows(*view, *raw));
  EXPECT_EQ(view->frame(first)->depth(9, 9), corrected->depth(9, 9));
  EXPECT_EQ(view->frame(second)->depth(9, 9), second->apply(raw->depth)(9, 9));
  // One that was corrected before anybody had it.
  RgbdFrame other = *corrected;
  other.index = 9;
  other.delivered = nullptr;
  const auto late = store.keep(other, first);
  EXPECT_NEAR(late->frame(first)->depth(9, 9), corrected->depth(9, 9), 2e-4);
  EXPECT_NEAR(late->frame(second)->depth(9, 9), second->apply(raw->depth)(9, 9), 2e-4);
}

// Whoever keeps it, whoever keeps it first, and with whatever calibration it is read.
TEST(ViewStore, WhatMovesIsKeptWithoutItsDepth) {
  DepthCalibration c;
  c.camera = kCamera;
  c.grid = {2, 2};
  c.offset_per_m.assign(4, 0.02);
  const auto calibration = std::make_shared<const DepthCalibration>(c);
  const auto raw = std::make_shared<const RgbdFrame>(frame_of(8));
  const auto corrected = copy_to_change(raw);
  corrected->depth = calibration->apply(raw->depth);
  PixelMask still(kCamera.width, kCamera.height, std::uint8_t{1});
  still(9, 9) = 0;
  const auto mask = std::make_shared<const PixelMask>(std::move(still));
  ViewStore store(1, {.least_in_memory = 1});
  const auto view = store.keep(*without_movers(corrected, mask), calibration);
  EXPECT_EQ(store.keep(*without_movers(raw, mask)), view);
  const auto newer = store.keep(frame_of(9));
  store.settle();
  EXPECT_EQ(store.bytes_in_memory(), kBytes) << "it lies on the disk";
  for (const CalibrationPtr& now : {CalibrationPtr(), calibration}) {
    const auto frame = view->frame(now);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->depth(9, 9), 0);
    EXPECT_FALSE(frame->sees(9, 9));
    EXPECT_TRUE(frame->sees(8, 9));
    EXPECT_TRUE(frame->color(9, 9) == raw->color(9, 9));
  }
  EXPECT_EQ(view->frame(nullptr)->depth(8, 9), raw->depth(8, 9));
}

TEST(ViewStore, OtherPicturesOfAFrameStandBesideItsOwn) {
  ViewStore store(1, {.least_in_memory = 1});
  const auto own = store.keep(frame_of(3));
  RgbdFrame coloured = frame_of(3);
  coloured.color.fill({200, 0, 0});
  auto other = store.keep_changed(coloured, nullptr);
  EXPECT_EQ(other->index(), 3);
  store.settle();
  EXPECT_EQ(store.bytes_in_memory(), kBytes);
  EXPECT_TRUE(shows(*own, frame_of(3)));
  EXPECT_TRUE(shows(*other, coloured));
  other.reset();
  EXPECT_EQ(store.keep(frame_of(3)), own);
  EXPECT_EQ(store.bytes_in_memory(), 0u) << "its own went to the disk first";
}

TEST(StoredView, FarDepthIsKeptInCoarserSteps) {
  RgbdFrame frame = frame_of(0);
  frame.depth(5, 5) = 14;
  frame.depth(6, 5) = 40;
  frame.depth(7, 5) = 1e9f;
  const auto near = StoredView(frame).frame(nullptr), far = StoredView(frame, 50).frame(nullptr);
  EXPECT_EQ(near->depth(5, 5), 0);
  EXPECT_NEAR(far->depth(5, 5), 14, 1e-3);
  EXPECT_NEAR(far->depth(6, 5), 40, 1e-3);
  EXPECT_EQ(far->depth(7, 5), 0);
}

TEST(ViewStore, TheOldestGoToTheDiskAndShowTheSame) {
  ViewStore store(10 * kBytes, {.least_in_memory = 4});
  auto views = keep(store, 0, 30);
  EXPECT_EQ(store.bytes_in_memory(), 10 * kBytes);
  for (std::size_t k = 20; k < 30; ++k) EXPECT_TRUE(shows(*views[k], frame_of(std::int64_t(k))));
  EXPECT_EQ(store.reads(), 0u);
  for (std::size_t k = 0; k < 20; ++k) EXPECT_TRUE(shows(*views[k], frame_of(std::int64_t(k))));
  EXPECT_EQ(store.reads(), 20u);
  const auto held = views[0]->pictures();
  EXPECT_EQ(views[0]->pictures(), held);  // and not read again
  EXPECT_EQ(store.reads(), 21u);
  store.note_beside(8 * kBytes);
  store.settle();
  EXPECT_EQ(store.excess_bytes(), 2 * kBytes);
  EXPECT_EQ(store.bytes_in_memory(), 4 * kBytes);
}

TEST(ViewStore, WhatNobodyHasMakesRoom) {
  ViewStore store(4 * kBytes, {.least_in_memory = 1});
  auto views = keep(store, 0, 12);
  for (std::size_t k = 0; k < 12; k += 2) views[k].reset();
  EXPECT_EQ(store.bytes_in_memory(), 2 * kBytes);
  auto more = keep(store, 12, 8);  // where others have lain
  for (std::size_t k = 1; k < 12; k += 2) EXPECT_TRUE(shows(*views[k], frame_of(std::int64_t(k))));
  for (std::size_t k = 0; k < 8; ++k) EXPECT_TRUE(shows(*more[k], frame_of(std::int64_t(12 + k))));
}

TEST(ViewStore, ViewsOutliveIt) {
  std::vector<StoredViewPtr> views;
  {
    ViewStore store(kBytes, {.least_in_memory = 1});
    views = keep(store, 0, 5);
  }
  for (std::size_t k = 0; k < 5; ++k) EXPECT_TRUE(shows(*views[k], frame_of(std::int64_t(k))));
}

TEST(ViewStore, ADamagedViewIsGoneAndTheOthersAreNot) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "views";
  std::filesystem::create_directories(folder);
  ViewStore store(kBytes, {.least_in_memory = 1, .folder = folder});
  auto views = keep(store, 0, 6);
  const int file = open_spill_file_in(folder);
  ASSERT_GE(file, 0);
  const char wrong = 1;
  ASSERT_EQ(::pwrite(file, &wrong, 1, std::int64_t(kBytes) + 77), 1);  // of the second view
  EXPECT_EQ(views[1]->pictures(), nullptr);
  EXPECT_EQ(views[1]->pictures(), nullptr);
  EXPECT_TRUE(shows(*views[0], frame_of(0)));
  // Most of the file is removed.
  ASSERT_EQ(::ftruncate(file, std::int64_t(kBytes)), 0);
  EXPECT_TRUE(shows(*views[0], frame_of(0)));
  EXPECT_EQ(views[2]->pictures(), nullptr);
  EXPECT_TRUE(shows(*views[5], frame_of(5)));
  ::close(file);
  auto more = keep(store, 6, 2);
  EXPECT_TRUE(shows(*more[0], frame_of(6)));
}

TEST(ViewStore, WithoutADiskMoreMemoryIsUsed) {
  ViewStore store(kBytes, {.least_in_memory = 1, .folder = "/no/such/folder"});
  auto views = keep(store, 0, 5);
  EXPECT_EQ(store.bytes_in_memory(), 5 * kBytes);
  EXPECT_EQ(store.excess_bytes(), 4 * kBytes);
  EXPECT_TRUE(shows(*views[0], frame_of(0)));
}

TEST(ViewStore, ADiskThatGetsFullKeepsWhatItHas) {
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{3 * kBytes + 100, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  ViewStore store(kBytes, {.least_in_memory = 1});
  auto views = keep(store, 0, 10);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(store.bytes_in_memory(), 7 * kBytes);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_TRUE(shows(*views[k], frame_of(std::int64_t(k))));
}

TEST(ViewStore, ServesManyThreads) {
  ViewStore store(5 * kBytes, {.least_in_memory = 1});
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t t = 0; t < wrong.size(); ++t) {
    threads.emplace_back([&, t] {
      std::vector<StoredViewPtr> mine;
      for (std::int64_t k = 0; k < 60; ++k) {
        const std::int64_t index = k + static_cast<std::int64_t>(t) / 2;  // shared by two
        mine.push_back(store.keep(frame_of(index)));
        if (t % 2 == 0) store.note_beside(static_cast<std::size_t>(k));
        const auto& old = mine[mine.size() / 2];
        wrong[t] += shows(*old, frame_of(old->index())) ? 0 : 1;
        if (mine.size() > 12) mine.erase(mine.begin());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
  EXPECT_EQ(store.bytes_in_memory(), 0u);
}

}  // namespace
}  // namespace sgs::history
