// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/camera/undistort.h"
#include "sgs/core/error.h"

namespace sgs::dataset {

/// The cameras that one frame's images were stored with: registered to each other (the same place,
/// the same axis, the same lens), but perhaps of different size.
struct StoredCameras {
  PinholeCamera color, depth;
};

/// The camera of the frames as delivered: the coarser of both grids, so that the finer one is
/// reduced and nothing is invented, and at most `max_width` columns (0 = no limit). A depth grid
/// with less than half the columns that colour may have does not hold colour back: then colour
/// decides, and each of its pixels takes the nearest depth.
PinholeCamera delivered_camera(const StoredCameras& stored, int max_width);

/// Brings stored images to the camera that a sequence delivers: one rule for intrinsics that change
/// from frame to frame, for colour and depth of different size, and for images that are too wide.
/// Colour is resampled, depth takes the nearest measurement; then the lens distortion is removed.
/// Images that fit already are passed on bit for bit. Immutable, thread-safe.
class FrameFit {
 public:
  FrameFit(const PinholeCamera& delivered, const Distortion& distortion);

  const PinholeCamera& camera() const { return camera_; }
  /// Which pixels of such frames the camera `color` saw; null: all.
  std::shared_ptr<const PixelMask> seen(const PinholeCamera& color) const;
  /// Sets colour, depth and camera of `frame`. Images that are not of their camera's size are
  /// refused; `color_name` and `depth_name` are what the message calls them.
  Status fit(ColorImage color, DepthImage depth, const StoredCameras& stored,
             std::string_view color_name, std::string_view depth_name, RgbdFrame& frame) const;

 private:
  PinholeCamera camera_;
  std::optional<Undistorter> undistorter_;
};

/// A warning with the share where less than a third of the pixels was seen, so that the calibration
/// is probably of another lens. `source` says where it came from.
std::optional<std::string> little_is_seen(const PixelMask* seen, std::string_view source);

/// Refuses depths that cannot be metres: a median of the measured ones beyond 0.05 .. 20 m.
/// `depth_scale` and `source` say in the message which unit was assumed and who said so. An image
/// without any depth passes.
Status check_depth_unit(const DepthImage& depth, double depth_scale, std::string_view source);

/// Warns of a median depth, in metres, that is possible but not usual for a room: the unit may be
/// another one. 0 = nothing was measured.
void warn_of_doubtful_unit(double median_m, std::vector<std::string>& warnings);

/// Warns where the principal point lies on the picture's rim or outside: mostly it was not filled
/// in. A part of a larger picture may have it there. `source` says who gave the camera.
void warn_of_doubtful_centre(const PinholeCamera& camera, std::string_view source,
                             std::vector<std::string>& warnings);

/// The median of what was measured, in metres; 0 where nothing was.
double median_depth_m(const DepthImage& depth);

}  // namespace sgs::dataset
