// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe_memory.h"

#include <algorithm>

#include "sgs/core/log.h"

namespace sgs::mapper {
namespace {

constexpr std::size_t kPicturesKept = 16;  // of the newest keyframes, whatever the budget
constexpr std::size_t kViewsKept = 64;     // likewise: they are visited most

}  // namespace

void KeyframeMemory::make_room(std::vector<MapKeyframe>& keyframes, TrainingViewCache& views,
                               std::size_t other_bytes) {
  const std::size_t count = keyframes.size();
  if (count == 0) return;
  const std::size_t picture = keyframes.front().picture_bytes();
  const std::size_t view = half_view_bytes(keyframes.front().camera());
  const auto from = [&](std::size_t first) {
    return std::count_if(keyframes.begin() + static_cast<std::ptrdiff_t>(first), keyframes.end(),
                         [](const MapKeyframe& k) { return !k.culled(); });
  };
  std::size_t used = picture * static_cast<std::size_t>(from(parked_)) +
                     view * static_cast<std::size_t>(from(views.first_half_kept())) + other_bytes;
  while (used > budget_bytes_ && parked_ + kPicturesKept < count && park(keyframes[parked_])) {
    if (!keyframes[parked_].culled()) used -= picture;
    ++parked_;
  }
  // A view can only go where its pictures can be read again at no more memory.
  const std::size_t most_dropped = std::min(parked_, count - std::min(count, kViewsKept));
  while (used > budget_bytes_ && views.first_half_kept() < most_dropped) {
    if (!keyframes[views.first_half_kept()].culled()) used -= view;
    views.drop_half(views.first_half_kept());
  }
}

bool KeyframeMemory::park(MapKeyframe& keyframe) {
  if (failed_) return false;
  Status status;
  if (!file_) {
    if (auto file = SpillFile::create()) {
      file_ = std::move(*file);
    } else {
      status = tl::unexpected(file.error());
    }
  }
  if (status) status = keyframe.park(*file_);
  failed_ = !status;
  if (failed_) {
    log().warn("pictures of keyframes stay in memory, beyond mapper.memory_mb: {}",
               status.error().text());
  }
  return !failed_;
}

}  // namespace sgs::mapper
