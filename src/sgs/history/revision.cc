// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/history/revision.h"

namespace sgs::history {

Revision revised(const Revision& before, const Update& update) {
  Revision out = before;
  out.path = before.path.moved(update.poses);
  if (update.calibration) {
    out.calibration = update.calibration;
    ++out.calibrations;
  } else if (update.tracked_anew) {
    ++out.second_looks;
  } else {
    ++out.loops;
  }
  return out;
}

std::shared_ptr<const DepthChange> depth_change(const CalibrationPtr& then,
                                                const CalibrationPtr& now) {
  if (then == now) return nullptr;
  const DepthCalibration none;
  return std::make_shared<const DepthChange>(then ? *then : none, now ? *now : none);
}

}  // namespace sgs::history
