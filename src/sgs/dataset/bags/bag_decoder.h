// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <optional>

#include "sgs/bag/bag.h"
#include "sgs/bag/pictures.h"
#include "sgs/camera/pair_rectifier.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/dataset/bags/bag_cameras.h"
#include "sgs/dataset/bags/bag_lens.h"
#include "sgs/dataset/bags/bag_modes.h"
#include "sgs/dataset/bags/bag_pairs.h"
#include "sgs/dataset/bags/bag_topics.h"

namespace sgs::dataset {

/// Decodes the images of topics.
class BagPictures {
 public:
  BagPictures(const bag::Bag& bag, const BagTopics& topics, const bag::DepthUnit& unit);
  Result<ColorImage> color(const bag::Message& message) const;
  Result<DepthImage> depth(const bag::Message& message) const;

 private:
  bool color_packed_, depth_packed_;
  bag::Encoding color_encoding_, depth_encoding_;
  bag::DepthUnit unit_;
};

/// Turns pairs of messages into frames of one camera: undistorted, depth brought into colour.
/// Pictures of another mode, with the camera info that was recorded with them or of another size of
/// the same view, are resampled to that camera.
class BagDecoder {
 public:
  BagDecoder(const bag::Bag& bag, const BagTopics& topics, const BagCameras& cameras);

  /// Sets the images of `frame`. Sizes that fit no known camera are kUnsupported.
  Status read(const BagPairs::Event& pair, RgbdFrame& frame);
  const BagPictures& pictures() const { return pictures_; }

 private:
  /// Pictures as they come in one mode.
  struct Mode {
    LensCamera color;
    std::optional<LensCamera> depth;
    ImageSize depth_size;
    PairRectifier rectifier;
  };
  struct Lens {
    std::optional<CameraInfoTrack> infos;
    bag::CameraInfoMessage known;  ///< what the plan's camera was made of
    std::string topic;
    bool rectified = false;
  };
  Result<LensCamera> color_lens(const BagPairs::Event& pair, ImageSize size);
  Result<std::optional<LensCamera>> depth_lens(const BagPairs::Event& pair, const LensCamera& color,
                                               ImageSize size);
  Result<LensCamera> lens_at(Lens& lens, const bag::Message& message, const LensCamera& planned,
                             std::int64_t stamp_ns, ImageSize size);
  Mode& mode_of(const LensCamera& color, const std::optional<LensCamera>& depth,
                ImageSize depth_size);

  BagCameras cameras_;
  BagPictures pictures_;
  Lens color_, depth_;
  std::list<Mode> modes_;  ///< the one used last first
};

}  // namespace sgs::dataset
