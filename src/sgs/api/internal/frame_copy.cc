// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/internal/frame_copy.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "sgs/io/image_io.h"

namespace sgs::api::internal {
namespace {

tl::unexpected<sgs::Error> bad_view(std::string message, std::string remedy) {
  return fail(sgs::ErrorCode::kInvalidArgument, std::move(message), std::move(remedy));
}

std::size_t channels(ColorFormat format) {
  return format == ColorFormat::kRgba || format == ColorFormat::kBgra ? 4 : 3;
}

std::size_t bytes_per_depth(DepthFormat format) {
  return format == DepthFormat::kUint16 ? sizeof(std::uint16_t) : sizeof(float);
}

/// Bytes from one row to the next.
std::ptrdiff_t stride_of(std::ptrdiff_t stride, int width, std::size_t pixel_bytes) {
  return stride != 0 ? stride
                     : static_cast<std::ptrdiff_t>(static_cast<std::size_t>(width) * pixel_bytes);
}

const std::uint8_t* row_of(const void* data, std::ptrdiff_t stride, int y) {
  return static_cast<const std::uint8_t*>(data) + stride * y;
}

struct ViewSize {
  const char* name;
  const void* data;
  int width, height;
  std::ptrdiff_t stride;
  std::size_t pixel_bytes;
};

Status check_view(const ViewSize& view, const PinholeCamera& camera) {
  if (view.data == nullptr) {
    return bad_view(fmt::format("the {} image is missing", view.name),
                    "feed colour and depth of each frame");
  }
  if (view.width != camera.width || view.height != camera.height) {
    return bad_view(fmt::format("the {} image has {}x{} pixels, the camera {}x{}", view.name,
                                view.width, view.height, camera.width, camera.height),
                    "feed images of the camera's size; depth is to be registered to colour");
  }
  const auto row =
      static_cast<std::ptrdiff_t>(static_cast<std::size_t>(view.width) * view.pixel_bytes);
  if (view.stride != 0 && std::abs(view.stride) < row) {
    return bad_view(fmt::format("rows of the {} image overlap: {} bytes apart, {} bytes long",
                                view.name, view.stride, row),
                    "the stride counts bytes from one row to the next");
  }
  return {};
}

template <int R, int G, int B, std::size_t kChannels>
void copy_swapped(const std::uint8_t* from, int width, Rgb8* to) {
  for (int x = 0; x < width; ++x, from += kChannels) to[x] = {from[R], from[G], from[B]};
}

void copy_color_row(const std::uint8_t* from, ColorFormat format, int width, Rgb8* to) {
  switch (format) {
    case ColorFormat::kRgb:
      std::memcpy(to, from, static_cast<std::size_t>(width) * sizeof(Rgb8));
      return;
    case ColorFormat::kBgr:
      return copy_swapped<2, 1, 0, 3>(from, width, to);
    case ColorFormat::kRgba:
      return copy_swapped<0, 1, 2, 4>(from, width, to);
    case ColorFormat::kBgra:
      return copy_swapped<2, 1, 0, 4>(from, width, to);
  }
}

template <class T>
void fit_size(Image<T>& image, int width, int height) {
  if (image.width() != width || image.height() != height) image = Image<T>(width, height);
}

/// All raw values in metres, by the rule of image files.
DepthImage raw_values_in_metres(double scale) {
  io::RawDepth raw(std::numeric_limits<std::uint16_t>::max() + 1, 1);
  for (int value = 0; value < raw.width(); ++value)
    raw(value, 0) = static_cast<std::uint16_t>(value);
  return io::depth_in_metres(raw, scale);
}

template <class T>
T value_at(const std::uint8_t* row, int x) {
  T value;
  std::memcpy(&value, row + static_cast<std::size_t>(x) * sizeof(T), sizeof(T));
  return value;
}

void copy_float_row(const std::uint8_t* from, float scale, int width, float* to) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (int x = 0; x < width; ++x) {
    const float z = value_at<float>(from, x) / scale;
    to[x] = z > 0 && z < kInfinite ? z : 0.0f;
  }
}

}  // namespace

Status check_views(const ColorView& color, const DepthView& depth, const PinholeCamera& camera) {
  SGS_RETURN_IF_ERROR(check_view(
      {"colour", color.data, color.width, color.height, color.stride, channels(color.format)},
      camera));
  SGS_RETURN_IF_ERROR(check_view(
      {"depth", depth.data, depth.width, depth.height, depth.stride, bytes_per_depth(depth.format)},
      camera));
  if (std::isfinite(depth.scale) && depth.scale > 0) return {};
  return bad_view(fmt::format("a depth scale of {} cannot be", depth.scale),
                  "give units per metre: 1000 for millimetres, 5000 for TUM, 1 for metres");
}

void copy_color(const ColorView& view, ColorImage& color) {
  fit_size(color, view.width, view.height);
  const std::ptrdiff_t stride = stride_of(view.stride, view.width, channels(view.format));
  for (int y = 0; y < view.height; ++y) {
    copy_color_row(row_of(view.data, stride, y), view.format, view.width, color.row(y));
  }
}

void DepthCopier::copy(const DepthView& view, DepthImage& depth) {
  fit_size(depth, view.width, view.height);
  const bool raw = view.format == DepthFormat::kUint16;
  if (raw && scale_ != view.scale) {
    metres_ = raw_values_in_metres(view.scale);
    scale_ = view.scale;
  }
  const std::ptrdiff_t stride = stride_of(view.stride, view.width, bytes_per_depth(view.format));
  for (int y = 0; y < view.height; ++y) {
    const std::uint8_t* from = row_of(view.data, stride, y);
    float* to = depth.row(y);
    if (raw) {
      for (int x = 0; x < view.width; ++x) to[x] = metres_.data()[value_at<std::uint16_t>(from, x)];
    } else {
      copy_float_row(from, static_cast<float>(view.scale), view.width, to);
    }
  }
}

}  // namespace sgs::api::internal
