// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/internal/frame_pool.h"

namespace sgs::api::internal {

std::shared_ptr<RgbdFrame> FramePool::take() {
  constexpr std::size_t kKept = 4;  // at most: a few frames are under way, keyframes stay for long
  std::unique_ptr<RgbdFrame> frame;
  {
    const std::lock_guard lock(shelf_->mutex);
    if (!shelf_->frames.empty()) {
      frame = std::move(shelf_->frames.back());
      shelf_->frames.pop_back();
    }
  }
  if (!frame) frame = std::make_unique<RgbdFrame>();
  const auto put_back = [shelf = std::weak_ptr<Shelf>(shelf_)](RgbdFrame* used) {
    std::unique_ptr<RgbdFrame> kept(used);
    const auto there = shelf.lock();
    if (!there) return;
    const std::lock_guard lock(there->mutex);
    if (there->frames.size() < kKept) there->frames.push_back(std::move(kept));
  };
  return {frame.release(), put_back};
}

}  // namespace sgs::api::internal
