// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/alignment/alignment_config.h"
#include "sgs/alignment/lost_reason.h"

namespace sgs::alignment {

/// Whether a frame has enough sampled points to be registered: kNone, kNoDepth or kTooFewPoints.
inline LostReason check_points(int points, const LossConfig& config) {
  if (points >= config.min_points) return LostReason::kNone;
  return points == 0 ? LostReason::kNoDepth : LostReason::kTooFewPoints;
}

/// Whether enough of a frame's points found a target: kNone or kTooFewMatches.
inline LostReason check_matches(int inliers, int points, const LossConfig& config) {
  const bool enough = inliers >= config.min_inliers && inliers >= config.min_inlier_share * points;
  return enough ? LostReason::kNone : LostReason::kTooFewMatches;
}

}  // namespace sgs::alignment
