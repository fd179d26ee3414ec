// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/bag/messages.h"
#include "sgs/bag/pictures.h"
#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/dataset/bags/bag_topics.h"
#include "sgs/dataset/open.h"
#include "sgs/geometry/se3.h"

namespace sgs::dataset {

/// A topic of camera info and the message that is believed.
struct CameraInfoSource {
  std::size_t channel = 0;
  bag::CameraInfoMessage info;
};

/// The cameras of a bag and how they stand to each other.
struct BagCameras {
  LensCamera color;
  /// Set where depth has to be brought into the colour camera; else both are the same camera.
  std::optional<LensCamera> depth;
  SE3 T_color_depth;
  bag::DepthUnit unit;
  /// Where the cameras come from, if from topics: what they say may change on the way.
  std::optional<CameraInfoSource> color_info, depth_info;
  // For people: who said so.
  std::string color_source, relation_source, unit_source;
  std::vector<std::string> warnings;
};

/// Reads the cameras from camera info messages, the extrinsics from what the recording says of them
/// (its SDK's topics, frame names, tf) or from `options.extrinsics`. Nothing is guessed: depth that
/// is not known to be registered and comes without extrinsics is an error that names the way out,
/// and so are two camera infos of one frame that are not one camera. Image sizes that are not known
/// (0 in `topics`) stay 0 in `color` where --camera gives the numbers.
Result<BagCameras> find_bag_cameras(const bag::Bag& bag, const BagTopics& topics,
                                    const OpenOptions& options);

}  // namespace sgs::dataset
