// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "sgs/history/revision.h"

namespace sgs::alignment {

/// What is believed of the past at the frame that is tracked, asked for in a tracker's local
/// coordinates: those of its first camera. The path ends with the frame before.
class LocalPast {
 public:
  explicit LocalPast(const SE3& T_local_odom = {}) : T_local_odom_(T_local_odom) {}

  void set_revision(const history::Revision& revision) {
    revision_ = revision;
    tracked_.reset();
  }
  const history::Revision& revision() const { return revision_; }
  /// The frame that is tracked is here: to be asked for until a path has it.
  void set_tracked(std::int64_t frame, const SE3& T_local_camera) {
    tracked_ = {frame, T_local_camera};
  }
  /// Camera to local of a frame, by its index.
  SE3 at(std::int64_t frame) const {
    if (tracked_ && tracked_->frame == frame) return tracked_->T_local_camera;
    return T_local_odom_ * revision_.path.at(frame);
  }

 private:
  struct Tracked {
    std::int64_t frame;
    SE3 T_local_camera;
  };
  SE3 T_local_odom_;
  history::Revision revision_;
  std::optional<Tracked> tracked_;
};

}  // namespace sgs::alignment
