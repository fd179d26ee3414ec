// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/page_pool.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <random>
#include <thread>
#include <vector>

namespace sgs {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kMiB = std::size_t{1} << 20;

TEST(PagePool, RoundsSizesUpByAnEighthAtTheMost) {
  PagePool pool(std::size_t{1} << 34, 0);
  for (std::size_t pages = 1; pages < 3000; pages += pages < 100 ? 1 : 37) {
    for (const std::size_t bytes : {(pages - 1) * kPage + 1, pages * kPage}) {
      void* block = pool.allocate(bytes);
      ASSERT_NE(block, nullptr);
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % kPage, 0u);
      EXPECT_TRUE(pool.owns(block));
      EXPECT_GE(pool.use().held, bytes);
      EXPECT_LE(8 * pool.use().held, 9 * pages * kPage);
      std::memset(block, 1, bytes);
      pool.deallocate(block);
    }
  }
  EXPECT_EQ(pool.use().held, 0u);
}

TEST(PagePool, ABlockThatIsGivenBackIsUsedAgain) {
  PagePool pool(64 * kMiB, 8 * kMiB);
  void* first = pool.allocate(kMiB);
  void* second = pool.allocate(kMiB);
  EXPECT_NE(first, second);
  std::memset(first, 7, kMiB);
  pool.deallocate(first);
  EXPECT_EQ(pool.use().waiting, kMiB);
  EXPECT_EQ(pool.allocate(kMiB - 100), first);  // with its pages: nobody has cleared it
  EXPECT_EQ(static_cast<unsigned char*>(first)[kMiB / 2], 7);
  EXPECT_EQ(pool.use().waiting, 0u);
  pool.deallocate(first);
  pool.deallocate(second);
  EXPECT_EQ(pool.use().addresses, 2 * kMiB);
}

TEST(PagePool, ReturnsThePagesOfThoseThatHaveWaitedLongest) {
  PagePool pool(64 * kMiB, 2 * kMiB);
  std::vector<void*> blocks;
  for (int k = 0; k < 4; ++k) {
    blocks.push_back(pool.allocate(kMiB));
    std::memset(blocks.back(), 7, kMiB);
  }
  for (void* block : blocks) pool.deallocate(block);
  EXPECT_EQ(pool.use().waiting, 2 * kMiB);
  // The last two have their pages still, the others come back clear, and no new addresses are used.
  std::vector<int> values;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    blocks[k] = pool.allocate(kMiB);
    values.push_back(static_cast<unsigned char*>(blocks[k])[100]);
  }
  EXPECT_EQ(values, (std::vector{7, 7, 0, 0}));
  EXPECT_EQ(pool.use().addresses, 4 * kMiB);
  for (void* block : blocks) pool.deallocate(block);
}

TEST(PagePool, MemoryIsWhatIsHeldAndTheBound) {
  PagePool pool(std::size_t{1} << 34, 4 * kMiB);
  std::mt19937 random(1);
  std::vector<void*> held;
  std::size_t most = 0;
  for (int k = 0; k < 20000; ++k) {
    if (held.size() < 40 && random() % 2 == 0) {
      held.push_back(pool.allocate(64 * 1024 + random() % kMiB));
    } else if (!held.empty()) {
      std::swap(held[random() % held.size()], held.back());
      pool.deallocate(held.back());
      held.pop_back();
    }
    ASSERT_LE(pool.use().waiting, 4 * kMiB);
    most = std::max(most, pool.use().held);
  }
  EXPECT_LT(pool.use().addresses, 20 * most);
  for (void* block : held) pool.deallocate(block);
}

TEST(PagePool, HasNoBlocksBeyondItsAddresses) {
  PagePool pool(4 * kMiB, kMiB);
  void* block = pool.allocate(3 * kMiB);
  EXPECT_NE(block, nullptr);
  EXPECT_EQ(pool.allocate(2 * kMiB), nullptr);
  EXPECT_EQ(pool.allocate(~std::size_t{0}), nullptr);
  pool.deallocate(block);
  PagePool none(0, kMiB);
  EXPECT_EQ(none.allocate(1), nullptr);
  EXPECT_FALSE(none.owns(&none));
}

TEST(PagePoolDeathTest, ABlockGivenBackTwiceEndsTheProgram) {
  PagePool pool(4 * kMiB, kMiB);
  void* block = pool.allocate(kPage);
  pool.deallocate(block);
  EXPECT_DEATH(pool.deallocate(block), "");
  int other = 0;
  EXPECT_DEATH(pool.deallocate(&other), "");
}

TEST(PagePool, ServesManyThreads) {
  PagePool pool(std::size_t{1} << 34, 2 * kMiB);
  std::vector<std::thread> threads;
  std::vector<int> broken(4, 0);
  for (unsigned t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      std::mt19937 random(t);
      std::vector<std::pair<unsigned char*, std::size_t>> held;
      for (int k = 0; k < 3000; ++k) {
        if (held.size() < 5) {
          const std::size_t bytes = kPage + random() % (kMiB / 2);
          auto* block = static_cast<unsigned char*>(pool.allocate(bytes));
          block[0] = block[bytes - 1] = static_cast<unsigned char>(t);
          held.emplace_back(block, bytes);
        } else {
          std::swap(held[random() % held.size()], held.back());
          const auto [block, bytes] = held.back();
          broken[t] += block[0] != t || block[bytes - 1] != t;
          pool.deallocate(block);
          held.pop_back();
        }
      }
      for (const auto& [block, bytes] : held) pool.deallocate(block);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(broken, std::vector<int>(4, 0));
  EXPECT_EQ(pool.use().held, 0u);
}

}  // namespace
}  // namespace sgs
