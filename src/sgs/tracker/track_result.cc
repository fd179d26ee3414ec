// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/track_result.h"

namespace sgs::tracker {

std::string to_string(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kOk:
      return "ok";
    case TrackingStatus::kDegenerate:
      return "degenerate";
    case TrackingStatus::kLost:
      return "lost";
  }
  return "unknown";
}

}  // namespace sgs::tracker
