// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/alignment/alignment_config.h"
#include "sgs/features/features_config.h"

namespace sgs::loops {

/// How one view is aligned to another: as frames are tracked, from where it is expected or from
/// where matched features say.
struct PairConfig {
  alignment::AlignerConfig aligner;
  features::OrbConfig orb;
  features::VisualPoseConfig visual_pose;
};

}  // namespace sgs::loops
