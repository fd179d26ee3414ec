// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "pictures.h"

#include <cstdint>
#include <utility>

#include "sgs/bag/pictures.h"
#include "sgs/io/text.h"

namespace sgs::cameras {
namespace {

/// The remedies of recordings do not help somebody who publishes.
tl::unexpected<Error> unusable(Error error, const char* remedy) {
  error.remedy = remedy;
  return tl::unexpected<Error>(std::move(error));
}

template <class Image>
std::string bytes_of(const Image& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(*image.data())};
}

template <class Message>
Result<Picture> color(const Message& message) {
  const auto image = bag::decode_color(message);
  if (!image) return unusable(image.error(), "publish colour as rgb8, bgr8, rgba8, bgra8 or mono8");
  return Picture{message.header, {image->width(), image->height()}, bytes_of(*image)};
}

template <class Message>
Result<Picture> depth(const Message& message, bool floats) {
  // Raw numbers: what they mean, the stream says.
  const auto image = bag::decode_depth(message, {1, false, false});
  if (!image) {
    return unusable(image.error(), "publish depth as 16UC1 (millimetres) or 32FC1 (metres)");
  }
  Picture out{message.header, {image->width(), image->height()}, {}, floats};
  if (floats) {
    out.bytes = bytes_of(*image);
    return out;
  }
  sgs::Image<std::uint16_t> raw(image->width(), image->height());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    raw.data()[i] = static_cast<std::uint16_t>(image->data()[i]);
  }
  out.bytes = bytes_of(raw);
  return out;
}

}  // namespace

Result<Picture> color_of(const bag::ImageMessage& message) { return color(message); }
Result<Picture> color_of(const bag::CompressedImageMessage& message) { return color(message); }
Result<Picture> depth_of(const bag::ImageMessage& message) {
  return depth(message, io::lower_case(message.encoding) == "32fc1");
}
Result<Picture> depth_of(const bag::CompressedImageMessage& message) {
  return depth(message, message.format.find("32FC1") != std::string::npos);
}

}  // namespace sgs::cameras
