// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "sgs/degeneracy/fusion.h"
#include "sgs/geometry/se3.h"

namespace sgs::alignment {

/// How well poses were predicted lately, and what that says of the next one: a prior for frames of
/// which little is left to align. A camera that is held or carried does not leap, and nothing else
/// tells so when most of what is seen moves by itself. Relative to the recording: a prediction that
/// is often wrong by a centimetre is believed to a centimetre.
class ExpectedMotion {
 public:
  /// Where the next frame is expected; empty: nobody knows (the camera was found again).
  void expect(const std::optional<SE3>& T_local_camera);
  /// Where it was.
  void learn(const SE3& T_local_camera);
  /// The prior as it counts at that pose, or nothing as long as too little is known. Student's t:
  /// who did leap after all is held back less the farther they are.
  std::optional<degeneracy::AxisPrior> prior(const SE3& T_local_camera) const;

 private:
  std::optional<SE3> expected_;
  std::deque<Vector6d> surprises_;           // log(expected^-1 found), newest last
  Matrix6d information_ = Matrix6d::Zero();  // of them; zero: too few
};

}  // namespace sgs::alignment
