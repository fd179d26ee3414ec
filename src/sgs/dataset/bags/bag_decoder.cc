// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_decoder.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "sgs/bag/messages.h"
#include "sgs/camera/resample.h"
#include "sgs/core/log.h"

namespace sgs::dataset {
namespace {

template <class T>
ImageSize image_size(const Image<T>& image) {
  return {image.width(), image.height()};
}

ImageSize lens_size(const LensCamera& lens) { return {lens.camera.width, lens.camera.height}; }

std::string size_in_words(ImageSize size) { return fmt::format("{}x{}", size.width, size.height); }

tl::unexpected<Error> other_size(const char* what, ImageSize image, ImageSize calibrated) {
  return fail(ErrorCode::kUnsupported,
              fmt::format("{} is {} but its calibration is for {}, which is another shape", what,
                          size_in_words(image), size_in_words(calibrated)),
              "give the calibration of pictures of this size: --camera for colour, --topics "
              "color_info=/TOPIC,depth_info=/TOPIC for both");
}

}  // namespace

BagPictures::BagPictures(const bag::Bag& bag, const BagTopics& topics, const bag::DepthUnit& unit)
    : color_packed_(topics.color.compressed),
      depth_packed_(topics.depth.compressed),
      color_encoding_(bag.channels()[topics.color.channel].encoding),
      depth_encoding_(bag.channels()[topics.depth.channel].encoding),
      unit_(unit) {}

Result<ColorImage> BagPictures::color(const bag::Message& message) const {
  if (color_packed_) {
    SGS_ASSIGN_OR_RETURN(const auto image, bag::read_compressed_image(message, color_encoding_));
    return bag::decode_color(image);
  }
  SGS_ASSIGN_OR_RETURN(const auto image, bag::read_image(message, color_encoding_));
  return bag::decode_color(image);
}

Result<DepthImage> BagPictures::depth(const bag::Message& message) const {
  if (depth_packed_) {
    SGS_ASSIGN_OR_RETURN(const auto image, bag::read_compressed_image(message, depth_encoding_));
    return bag::decode_depth(image, unit_);
  }
  SGS_ASSIGN_OR_RETURN(const auto image, bag::read_image(message, depth_encoding_));
  return bag::decode_depth(image, unit_);
}

BagDecoder::BagDecoder(const bag::Bag& bag, const BagTopics& topics, const BagCameras& cameras)
    : cameras_(cameras), pictures_(bag, topics, cameras.unit) {
  const auto follow = [&](Lens& lens, const std::optional<CameraInfoSource>& source,
                          const ImageTopic& images) {
    lens.topic = bag.channels()[images.channel].topic;
    lens.rectified = is_rectified(lens.topic);
    if (!source) return;
    lens.infos.emplace(bag, source->channel);
    lens.known = source->info;
    lens.topic = bag.channels()[source->channel].topic;
  };
  follow(color_, cameras.color_info, topics.color);
  follow(depth_, cameras.depth_info, topics.depth);
}

/// The lens of a picture: the planned one, unless another camera info came with it or its size is
/// another.
Result<LensCamera> BagDecoder::lens_at(Lens& lens, const bag::Message& message,
                                       const LensCamera& planned, std::int64_t stamp_ns,
                                       ImageSize size) {
  const auto* info = lens.infos ? lens.infos->at(stamp_ns, message.record_time_ns) : nullptr;
  if (info != nullptr && !same_camera_info(*info, lens.known)) {
    std::vector<std::string> said_before;
    const auto other = lens_of(*info, lens.topic, lens.rectified, size, said_before);
    if (other) return same_lens(*other, planned) ? planned : *other;
  }
  if (size == lens_size(planned)) return planned;
  if (same_shape(size, lens_size(planned))) return scaled_lens(planned, size);
  return other_size(lens.topic.c_str(), size, lens_size(planned));
}

Result<LensCamera> BagDecoder::color_lens(const BagPairs::Event& pair, ImageSize size) {
  return lens_at(color_, pair.color, cameras_.color, pair.stamp_ns, size);
}

/// Empty where depth comes in the pixels of colour.
Result<std::optional<LensCamera>> BagDecoder::depth_lens(const BagPairs::Event& pair,
                                                         const LensCamera& color, ImageSize size) {
  if (cameras_.depth) {
    SGS_ASSIGN_OR_RETURN(const LensCamera lens,
                         lens_at(depth_, pair.depth, *cameras_.depth, pair.stamp_ns, size));
    return std::optional(lens);
  }
  if (size == lens_size(color)) return std::optional<LensCamera>{};
  if (same_shape(size, lens_size(color))) return std::optional(scaled_lens(color, size));
  return fail(
      ErrorCode::kUnsupported,
      fmt::format("depth is registered ({}), but it is {} and colour {}, which is another "
                  "shape and so another view",
                  cameras_.relation_source, size_in_words(size), size_in_words(lens_size(color))),
      "name depth's own calibration, by which it is brought into colour: --topics "
      "depth_info=/TOPIC; or record depth that is aligned to colour");
}

BagDecoder::Mode& BagDecoder::mode_of(const LensCamera& color,
                                      const std::optional<LensCamera>& depth,
                                      ImageSize depth_size) {
  constexpr std::size_t kMostModes = 4;
  const auto known = std::find_if(modes_.begin(), modes_.end(), [&](const Mode& mode) {
    return mode.color == color && mode.depth == depth && mode.depth_size == depth_size;
  });
  if (known != modes_.end()) {
    modes_.splice(modes_.begin(), modes_, known);
    return modes_.front();
  }
  if (!modes_.empty()) {
    log().warn(
        "the cameras change their mode: colour is {} now, depth {}; all frames are brought to the "
        "camera of the most, {}",
        size_in_words(lens_size(color)), size_in_words(depth_size),
        size_in_words(lens_size(cameras_.color)));
  }
  modes_.push_front(
      {color, depth, depth_size, PairRectifier(color, depth, cameras_.T_color_depth)});
  if (modes_.size() > kMostModes) modes_.pop_back();
  return modes_.front();
}

Status BagDecoder::read(const BagPairs::Event& pair, RgbdFrame& frame) {
  SGS_ASSIGN_OR_RETURN(ColorImage color, pictures_.color(pair.color));
  SGS_ASSIGN_OR_RETURN(DepthImage depth, pictures_.depth(pair.depth));
  SGS_ASSIGN_OR_RETURN(const LensCamera lens, color_lens(pair, image_size(color)));
  SGS_ASSIGN_OR_RETURN(const auto own_depth, depth_lens(pair, lens, image_size(depth)));
  const ImageSize depth_size = image_size(depth);
  mode_of(lens, own_depth, depth_size).rectifier.rectify(std::move(color), std::move(depth), frame);
  const PinholeCamera& delivered = cameras_.color.camera;
  if (lens.camera != delivered) {
    frame.camera = lens.camera;
    frame = resampled(std::move(frame), delivered);
  }
  return {};
}

}  // namespace sgs::dataset
