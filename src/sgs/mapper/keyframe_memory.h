// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sgs/core/spill_file.h"
#include "sgs/mapper/keyframe.h"

namespace sgs::mapper {

/// Keeps what keyframes hold in memory within a budget, without any effect on what is computed.
/// Beyond it the pictures of the oldest keyframes go to disk: few steps need them, as most work at
/// half resolution. When only the newest pictures are left, the oldest half-resolution views go,
/// too, and are made anew from the pictures whenever they are visited.
class KeyframeMemory {
 public:
  explicit KeyframeMemory(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// To be called when a keyframe has been added; `other_bytes` is what else there is that grows
  /// with their number. A disk that is full, or none that can be written
  /// to, is one warning: more memory is used then.
  void make_room(std::vector<MapKeyframe>& keyframes, TrainingViewCache& views,
                 std::size_t other_bytes = 0);
  /// Nothing is learned from that keyframe any more.
  void cull(MapKeyframe& keyframe) { keyframe.cull(file_ ? &*file_ : nullptr); }

 private:
  bool park(MapKeyframe& keyframe);

  std::size_t budget_bytes_;
  std::optional<SpillFile> file_;
  std::size_t parked_ = 0;  // before that one, none has pictures in memory
  bool failed_ = false;
};

}  // namespace sgs::mapper
