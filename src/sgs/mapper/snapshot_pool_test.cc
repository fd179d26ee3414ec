// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/snapshot_pool.h"

#include <gtest/gtest.h>

#include <thread>

namespace sgs::mapper {
namespace {

TEST(SnapshotPool, UsesTheMemoryOfReleasedSnapshotsAgain) {
  SnapshotPool pool;
  auto first = pool.take(100);
  first->gaussians.resize(100);
  const map::Gaussian* memory = first->gaussians.data();
  const auto second = pool.take(100);
  EXPECT_NE(second.get(), first.get());  // the first one is still held
  first.reset();
  auto third = pool.take(110);
  third->gaussians.resize(110);
  EXPECT_EQ(third->gaussians.data(), memory);  // the slack is enough
  third.reset();
  EXPECT_GE(pool.take(1000)->gaussians.capacity(), 1000u);
}

TEST(SnapshotPool, SnapshotsOutliveIt) {
  auto pool = std::make_unique<SnapshotPool>();
  auto snapshot = pool->take(10);
  snapshot->version = 7;
  pool.reset();
  EXPECT_EQ(snapshot->version, 7u);
  std::thread([held = std::move(snapshot)]() mutable { held.reset(); }).join();
}

TEST(SnapshotPool, ReadersOnOtherThreadsMayLetGo) {
  SnapshotPool pool;
  std::vector<std::thread> readers;
  for (int i = 0; i < 50; ++i) {
    auto snapshot = pool.take(64);
    snapshot->gaussians.assign(64, map::Gaussian{});
    snapshot->gaussians[0].mean[0] = static_cast<float>(i);
    readers.emplace_back([i, held = map::SnapshotPtr(std::move(snapshot))] {
      EXPECT_EQ(held->gaussians[0].mean[0], static_cast<float>(i));
    });
  }
  for (std::thread& reader : readers) reader.join();
}

}  // namespace
}  // namespace sgs::mapper
