// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"

namespace sgs {

/// Removes lens distortion from registered colour and depth. The output camera has the
/// input's intrinsics (as TUM's evaluation tools assume). Colour is interpolated bilinearly, depth
/// takes the nearest measurement; pixels without a source become black / 0. Immutable, thread-safe.
class Undistorter {
 public:
  Undistorter(const PinholeCamera& camera, const Distortion& distortion);
  ~Undistorter();
  Undistorter(Undistorter&&) noexcept;
  Undistorter& operator=(Undistorter&&) noexcept;

  ColorImage color(const ColorImage& distorted) const;
  DepthImage depth(const DepthImage& distorted) const;
  /// The same for a mask of pixels that mean something; outside the picture nothing does.
  PixelMask mask(const PixelMask& distorted) const;
  /// Which pixels of the output the lens shows: those with a source inside the picture, nearer than
  /// where the model folds back. Null where that is all of them.
  const std::shared_ptr<const PixelMask>& seen() const { return seen_; }

 private:
  struct Maps;
  std::unique_ptr<const Maps> maps_;
  std::shared_ptr<const PixelMask> seen_;
};

}  // namespace sgs
