// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sgs/mapper/keyframe.h"

namespace sgs::refine {

/// A frame with a pose: what is trained on, or what judges.
struct RefineFrame {
  mapper::MapKeyframe keyframe;
  double timestamp_s = 0;
  double sharpness = 0;  ///< mean square of the grey values' Laplacian, 0..1 squared
  double weight = 1;     ///< how often it is visited, relative to others
  /// Camera twist over the readout of a rolling shutter, rotation first; zero: global shutter.
  Vector6d readout = Vector6d::Zero();
};

/// Mean square of the Laplacian of the grey values (0..1): small where motion or focus blur a
/// picture. Only pictures of the same place compare. 0 for pictures of less than three rows or
/// columns.
double sharpness(const ColorImage& color);

/// Collects frames within a memory bound: of each `group` frames in a row the sharpest one stays.
/// The group is made as large as the expected number of frames asks for.
class FrameSelection {
 public:
  /// `expected`: frames that will come at most, >= 0; `budget_bytes` for their pictures.
  FrameSelection(const PinholeCamera& camera, std::int64_t expected, std::size_t budget_bytes);

  /// Takes a frame or leaves it; frames come in time order.
  void offer(const RgbdFrame& frame, const SE3& T_world_camera,
             const Vector6d& readout = Vector6d::Zero());
  /// The frames chosen, weighted by how sharp they are beside their neighbours in time.
  std::vector<RefineFrame> finish();
  std::int64_t group() const { return group_; }

 private:
  std::int64_t group_;
  std::int64_t offered_ = 0;
  std::vector<RefineFrame> frames_;
};

}  // namespace sgs::refine
