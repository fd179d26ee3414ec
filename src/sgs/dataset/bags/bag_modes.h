// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "sgs/bag/bag.h"
#include "sgs/bag/messages.h"
#include "sgs/core/error.h"

namespace sgs::dataset {

/// The camera info that most pictures at the beginning of a recording have: drivers start in one
/// mode and go on in another.
struct UsualCameraInfo {
  bag::CameraInfoMessage info;
  bool changes = false;  ///< there are others, too
};
Result<UsualCameraInfo> usual_camera_info(const bag::Bag& bag, std::size_t channel);

/// Whether two messages describe one camera.
bool same_camera_info(const bag::CameraInfoMessage& a, const bag::CameraInfoMessage& b);

/// The camera info that belongs to each picture of a topic, read along with it.
class CameraInfoTrack {
 public:
  CameraInfoTrack(const bag::Bag& bag, std::size_t channel);

  /// The info with the picture's stamp, or else the last one that was recorded before it; the first
  /// one for pictures before that. Pictures must be asked for in about their order. Null where no
  /// info can be read.
  const bag::CameraInfoMessage* at(std::int64_t stamp_ns, std::int64_t record_time_ns);

 private:
  struct Recorded {
    std::int64_t record_time_ns = 0;
    bag::CameraInfoMessage info;
  };
  void read_ahead();
  bool next_is_due(std::int64_t record_time_ns) const;

  const bag::Channel& about_;
  std::unique_ptr<bag::Cursor> cursor_;
  std::optional<Recorded> current_;
  std::deque<Recorded> ahead_;
  bool ended_ = false;
};

}  // namespace sgs::dataset
