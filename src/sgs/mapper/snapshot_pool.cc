// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/snapshot_pool.h"

namespace sgs::mapper {

std::shared_ptr<map::Snapshot> SnapshotPool::take(std::size_t count) {
  std::unique_ptr<map::Snapshot> snapshot;
  {
    const std::scoped_lock lock(shelf_->mutex);
    if (!shelf_->unused.empty()) {
      snapshot = std::move(shelf_->unused.back());
      shelf_->unused.pop_back();
    }
  }
  if (!snapshot) snapshot = std::make_unique<map::Snapshot>();
  if (snapshot->gaussians.capacity() < count) {
    // Cleared first: what it held need not move. Some slack, as maps grow.
    snapshot->gaussians.clear();
    snapshot->anchors.clear();
    snapshot->gaussians.reserve(count + count / 4);
    snapshot->anchors.reserve(count + count / 4);
  }
  return {snapshot.release(), [shelf = shelf_](map::Snapshot* unused) {
            std::unique_ptr<map::Snapshot> own(unused);
            const std::scoped_lock lock(shelf->mutex);
            if (shelf->unused.size() < Shelf::kMost) shelf->unused.push_back(std::move(own));
          }};
}

}  // namespace sgs::mapper
