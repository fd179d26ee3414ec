// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <limits>
#include <stdexcept>
#include <thread>

#include "sgs/core/bounded_queue.h"
#include "sgs/core/error.h"
#include "sgs/core/image.h"
#include "sgs/core/stopwatch.h"
#include "sgs/core/text.h"
#include "sgs/core/thread_pool.h"

namespace sgs {
namespace {

TEST(BoundedQueue, KeepsOrderAndBlocksWhenFull) {
  BoundedQueue<int> queue(3, FullPolicy::kBlock);
  std::atomic<int> pushed{0};
  std::thread producer([&] {
    for (int i = 0; i < 100; ++i) {
      queue.push(i);
      ++pushed;
    }
    queue.close();
  });
  int popped = 0;
  while (const auto value = queue.pop()) {
    EXPECT_EQ(*value, popped++);
    EXPECT_LE(pushed, popped + 3);
    EXPECT_LE(queue.size(), 3u);
  }
  producer.join();
  EXPECT_EQ(popped, 100);
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(BoundedQueue, DropsTheOldestAndCounts) {
  BoundedQueue<int> queue(2, FullPolicy::kDropOldest);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(queue.push(i));
  EXPECT_EQ(queue.dropped(), 3u);
  EXPECT_EQ(queue.try_pop(), 3);
  EXPECT_EQ(queue.try_pop(), 4);
  EXPECT_EQ(queue.try_pop(), std::nullopt);
}

TEST(BoundedQueue, CloseWakesBothSides) {
  BoundedQueue<int> full(1, FullPolicy::kBlock), empty(1, FullPolicy::kBlock);
  ASSERT_TRUE(full.push(1));
  std::thread pusher([&] { EXPECT_FALSE(full.push(2)); });
  std::thread popper([&] { EXPECT_EQ(empty.pop(), std::nullopt); });
  full.close();
  empty.close();
  pusher.join();
  popper.join();
  EXPECT_FALSE(full.push(3));
  EXPECT_EQ(full.pop(), 1);
  EXPECT_EQ(full.pop(), std::nullopt);
}

TEST(ThreadPool, RunsEveryChunkOnceForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.threads(), threads);
    for (const int chunks : {0, 1, 2, 7, 1000}) {
      std::vector<std::atomic<int>> runs(static_cast<std::size_t>(chunks));
      pool.run(chunks, [&](int chunk, int worker) {
        EXPECT_GE(worker, 0);
        EXPECT_LT(worker, threads);
        ++runs[static_cast<std::size_t>(chunk)];
      });
      for (const auto& count : runs) EXPECT_EQ(count, 1);
    }
  }
  EXPECT_THROW(ThreadPool(0), ContractViolation);
}

TEST(ThreadPool, RethrowsAndStaysUsable) {
  for (const int threads : {1, 4}) {
    ThreadPool pool(threads);
    const auto broken = [](int chunk, int) {
      if (chunk == 3) throw std::runtime_error("chunk 3");
    };
    EXPECT_THROW(pool.run(10, broken), std::runtime_error);
    std::atomic<int> count{0};
    pool.run(10, [&](int, int) { ++count; });
    EXPECT_EQ(count, 10);
  }
}

TEST(ThreadPool, SurvivesManyShortLoopsAndPausesBetweenThem) {
  ThreadPool pool(3);
  for (int loop = 0; loop < 20000; ++loop) {
    const int chunks = 2 + loop % 5;
    std::array<int, 6> seen{};  // plain integers: each chunk is one thread's alone
    pool.run(chunks, [&](int chunk, int) { seen[static_cast<std::size_t>(chunk)] += loop + 1; });
    for (int i = 0; i < chunks; ++i) ASSERT_EQ(seen[static_cast<std::size_t>(i)], loop + 1);
    // Long enough for the workers to fall asleep.
    if (loop % 5000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

TEST(ThreadPool, TheLastThreadRestsDuringARecess) {
  ThreadPool pool(3);
  const auto runs_of_last = [&pool] {
    std::atomic<int> count{0};
    pool.run(200, [&](int, int worker) {
      count += worker == 2 ? 1 : 0;
      std::this_thread::sleep_for(std::chrono::microseconds(20));
    });
    return count.load();
  };
  const auto comes_back = [&] {
    for (int loop = 0; loop < 1000; ++loop) {
      if (runs_of_last() > 0) return true;
    }
    return false;
  };
  EXPECT_TRUE(comes_back());
  {
    const ThreadPool::Recess outer(pool);
    EXPECT_EQ(runs_of_last(), 0);
    { const ThreadPool::Recess inner(pool); }
    for (int loop = 0; loop < 20; ++loop) EXPECT_EQ(runs_of_last(), 0);
  }
  EXPECT_TRUE(comes_back());
}

// On a machine that is busy otherwise the wait may run out; without it nearly every try would fail.
TEST(ThreadPool, ARecessBeginsWhenTheLastThreadHasFinishedItsChunk) {
  using Clock = std::chrono::steady_clock;
  ThreadPool pool(2);
  std::atomic<bool> inside{false}, done{false};
  std::thread user([&] {
    while (!done) {
      pool.run(64, [&](int, int worker) {
        if (worker == 1) inside = true;
        for (const auto end = Clock::now() + std::chrono::microseconds(100); Clock::now() < end;) {
        }
        if (worker == 1) inside = false;
      });
    }
  });
  int kept = 0;
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    while (!inside) std::this_thread::yield();
    const ThreadPool::Recess recess(pool);
    kept += inside ? 0 : 1;
  }
  done = true;
  user.join();
  EXPECT_GT(kept, kTries / 10);
}

TEST(ThreadPool, RecessesOfAnotherThreadLoseNoChunks) {
  for (const int threads : {1, 2, 3}) {
    ThreadPool pool(threads);
    std::atomic<bool> done{false};
    std::thread other([&] {
      while (!done) {
        const ThreadPool::Recess recess(pool);
        std::this_thread::yield();
      }
    });
    for (int loop = 0; loop < 1000; ++loop) {
      std::array<int, 6> seen{};
      pool.run(6, [&](int chunk, int) {
        // Long enough for the others to take part.
        const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(5);
        while (std::chrono::steady_clock::now() < end) {
        }
        seen[static_cast<std::size_t>(chunk)] += loop + 1;
      });
      for (const int value : seen) ASSERT_EQ(value, loop + 1);
    }
    done = true;
    other.join();
  }
}

TEST(ThreadPool, MayEndRightAfterARecess) {
  for (int i = 0; i < 50; ++i) {
    ThreadPool pool(2);
    const ThreadPool::Recess recess(pool);
    std::atomic<int> count{0};
    pool.run(4, [&](int, int) { ++count; });
    EXPECT_EQ(count, 4);
  }
}

TEST(Image, BytesAreRoundedAndClamped) {
  EXPECT_EQ(to_byte(0.0f), 0);
  EXPECT_EQ(to_byte(0.5f), 128);
  EXPECT_EQ(to_byte(1.0f), 255);
  EXPECT_EQ(to_byte(7.0f), 255);
  EXPECT_EQ(to_byte(-0.1f), 0);
  EXPECT_EQ(to_byte(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Text, NearestWordHasTheFewestTypingErrors) {
  const std::string_view words[] = {"tracker.kind", "mapper.steps", "mapper.stop", "seed"};
  EXPECT_EQ(nearest_word("mapper.step", words), "mapper.steps");  // the first of two as near
  EXPECT_EQ(nearest_word("traker.knd", words), "tracker.kind");
  EXPECT_EQ(nearest_word("sed", words), "seed");
  EXPECT_EQ(nearest_word("", words), "seed");
  EXPECT_EQ(nearest_word("maper.stop" + std::string(9000, 'x'), words), "mapper.stop");
  EXPECT_EQ(nearest_word("a", {}), "");
}

TEST(Text, PrintableKeepsWordsAndHidesWhatATerminalObeys) {
  EXPECT_EQ(printable("/camera/Bär"), "/camera/Bär");
  EXPECT_EQ(printable("a\x1b[2Jb\n\x7f"), "a?[2Jb??");
  EXPECT_EQ(printable("\xff\xc3"), "??");
}

TEST(Stopwatch, QuantilesAndMerging) {
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile({4, 1, 2, 3}, 0.5), 2.5);
  EXPECT_EQ(quantile({1, 2}, 0), 1);
  EXPECT_EQ(quantile({1, 2}, 1), 2);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
  StageTimes a, b;
  a.add("track", 1);
  b.add("track", 2);
  { const ScopedTimer timer(b, "map"); }
  a.merge(b);
  EXPECT_THAT(a.stages().at("track").values_ms, testing::ElementsAre(1, 2));
  EXPECT_GE(a.stages().at("map").values_ms.at(0), 0);
}

TEST(Stopwatch, IntervalsKeepTheirThreadThroughMerging) {
  StageTimes tracking("tracking"), mapping("mapping");
  tracking.add("track", 5);  // has no place in time
  tracking.add_interval("track", 10, 3);
  mapping.add_trace_only("map/iteration", 11, 4);
  tracking.merge(mapping);
  ASSERT_EQ(tracking.intervals().size(), 2u);
  EXPECT_EQ(tracking.intervals()[0].thread, "tracking");
  EXPECT_EQ(tracking.intervals()[1].thread, "mapping");
  EXPECT_EQ(tracking.intervals()[1].start_s, 11);
  EXPECT_THAT(tracking.stages().at("track").values_ms, testing::ElementsAre(5, 3));
  EXPECT_EQ(tracking.stages().count("map/iteration"), 0u);
}

TEST(Stopwatch, HoursOfTimesTakeBoundedMemory) {
  StageTimes times("mapping"), others;
  constexpr std::size_t kCalls = 3 * StageTimes::kMostIntervals / 2;
  for (std::size_t i = 0; i < kCalls; ++i) {
    times.add_interval("step", static_cast<double>(i), static_cast<double>(i % 100));
  }
  EXPECT_EQ(times.intervals().size(), StageTimes::kMostIntervals);
  EXPECT_EQ(times.intervals().back().start_s, kCalls - 1.0);
  others.add("step", 7);
  others.merge(times);
  const StageTimes::Stage& stage = others.stages().at("step");
  EXPECT_EQ(stage.calls, kCalls + 1);
  EXPECT_LE(stage.values_ms.size(), StageTimes::kMostValues);
  EXPECT_NEAR(stage.total_ms, 49.5 * kCalls, 2000);
  EXPECT_NEAR(quantile(stage.values_ms, 0.5), 50, 10);  // 64 and 100: every 16th value is met
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(ThreadPool, ThreadsThatCannotBeMadeAreAnException) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto make_too_many = [] {
    const rlimit little{400 << 20, 400 << 20};  // address space: a few dozen stacks
    setrlimit(RLIMIT_AS, &little);
    try {
      const ThreadPool pool(4000);
    } catch (const std::exception&) {
      std::_Exit(0);  // and not a deadlock
    }
    std::_Exit(1);
  };
  EXPECT_EXIT(make_too_many(), testing::ExitedWithCode(0), "");
}
#endif

}  // namespace
}  // namespace sgs
