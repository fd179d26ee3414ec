// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/history/path.h"

#include <algorithm>

#include "sgs/core/error.h"

namespace sgs::history {

// Mostly every frame is there, and found at once: as many entries after the first as its index is
// greater. Where frames were left out it lies before that.
const Path::Entry* Path::find(std::int64_t frame) const {
  if (empty() || frame < (*this)[0].frame || frame > back().frame) return nullptr;
  std::size_t begin = 0;
  std::size_t end = std::min(size_ - 1, static_cast<std::size_t>(frame - (*this)[0].frame));
  while (begin < end && (*this)[end].frame != frame) {
    const std::size_t middle = begin + (end - begin) / 2;
    if ((*this)[middle].frame < frame) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  const Entry& found = (*this)[end];
  return found.frame == frame ? &found : nullptr;
}

const SE3& Path::at(std::int64_t frame) const {
  const Entry* entry = find(frame);
  SGS_CHECK(entry != nullptr, "a frame that is not in the path");
  return entry->T_odom_camera;
}

void Path::append(const Entry& entry) {
  SGS_CHECK(empty() || entry.frame > back().frame, "frames come in the order of their indices");
  const std::size_t place = size_ % kBlock;
  if (place == 0) {
    auto blocks = blocks_ ? std::make_shared<Blocks>(*blocks_) : std::make_shared<Blocks>();
    blocks->resize(size_ / kBlock);
    blocks->push_back(std::make_shared<Block>());
    blocks_ = std::move(blocks);
  }
  std::size_t free = place;
  if (!blocks_->back()->used.compare_exchange_strong(free, place + 1)) {
    auto block = std::make_shared<Block>();
    std::copy_n(blocks_->back()->entries.begin(), place, block->entries.begin());
    block->used = place + 1;
    auto blocks = std::make_shared<Blocks>(*blocks_);
    blocks->back() = std::move(block);
    blocks_ = std::move(blocks);
  }
  blocks_->back()->entries[place] = entry;
  ++size_;
}

Path Path::moved(const PoseCorrection& correction) const {
  Path out;
  for (std::size_t k = 0; k < size_; ++k) {
    Entry entry = (*this)[k];
    entry.T_odom_camera = correction.corrected(entry.T_odom_camera, entry.timestamp_s);
    out.append(entry);
  }
  return out;
}

}  // namespace sgs::history
