// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "sgs/map/gaussian.h"

namespace sgs::mapper {

/// Snapshots whose memory is used again once nobody holds them any more: asking the system for
/// several megabytes and giving them back several times a second costs more than filling them.
/// Thread-safe; snapshots may outlive the pool.
class SnapshotPool {
 public:
  /// One that nobody else holds, with whatever it held before, and room for `count` Gaussians.
  std::shared_ptr<map::Snapshot> take(std::size_t count);

 private:
  struct Shelf {
    static constexpr std::size_t kMost = 2;  ///< kept; readers hold the newest ones anyway
    std::mutex mutex;
    std::vector<std::unique_ptr<map::Snapshot>> unused;
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace sgs::mapper
