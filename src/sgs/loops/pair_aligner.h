// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sgs/alignment/joint_aligner.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/loops/loop_config.h"

namespace sgs::loops {

/// What aligning one view to another came to.
struct PairAlignment {
  SE3 T_reference_camera;
  /// On twists of the aligned camera, pixels and points counted as independent.
  Matrix6d information = Matrix6d::Zero();
  double used = 0;     ///< share of the reference's pixels that fit
  double overlap = 0;  ///< share of the aligned view's points that fit
  double mean_cost = 0;
};

/// What it is worth as an edge of the graph (edge_information()); empty where too little fits.
std::optional<Matrix6d> information_of(const PairAlignment& alignment, double mean_depth_m,
                                       const LoopConfig& config);

/// Aligns views to a reference view as the tracker aligns frames to its map (JointAligner), and
/// with the same right to say that it cannot.
class PairAligner {
 public:
  /// `motion` is that of the camera while the reference was measured.
  PairAligner(const alignment::AlignerConfig& config, const RgbdFrame& reference,
              const registration::FrameMotion& motion);

  /// Empty where the alignment is not to be trusted.
  std::optional<PairAlignment> align(const RgbdFrame& frame,
                                     const registration::FrameMotion& motion, const SE3& T_start);

 private:
  alignment::JointAligner aligner_;
  history::Revision reference_;  // alone, and where the local coordinates are
};

}  // namespace sgs::loops
