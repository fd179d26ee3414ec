// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/resample.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "sgs/camera/opencv_threads.h"

namespace sgs {
namespace {

/// Source coordinate = scale * target coordinate + offset, along one axis.
struct AxisMap {
  double scale, offset;
  double operator()(double target) const { return scale * target + offset; }
};

AxisMap axis_map(double f_from, double c_from, double f_to, double c_to) {
  const double scale = f_from / f_to;
  return {scale, c_from - scale * c_to};
}

AxisMap map_x(const PinholeCamera& from, const PinholeCamera& to) {
  return axis_map(from.fx, from.cx, to.fx, to.cx);
}
AxisMap map_y(const PinholeCamera& from, const PinholeCamera& to) {
  return axis_map(from.fy, from.cy, to.fy, to.cy);
}

/// Whether no pixel of an axis of `size` pixels moves by as much as would show.
bool is_identity(const AxisMap& map, int size) {
  constexpr double kInvisible_px = 0.01;
  return std::abs(map(0)) < kInvisible_px && std::abs(map(size - 1) - (size - 1)) < kInvisible_px;
}

int reduced_size(int size, double scale) {
  return std::max(1, static_cast<int>(std::lround(size / std::max(1.0, scale))));
}

/// Nearest source pixel of each target pixel; -1 = outside.
std::vector<int> nearest_pixels(const AxisMap& map, int source_size, int target_size) {
  std::vector<int> nearest(static_cast<std::size_t>(target_size));
  for (int i = 0; i < target_size; ++i) {
    const double at = std::floor(map(i) + 0.5);
    nearest[static_cast<std::size_t>(i)] = at >= 0 && at < source_size ? static_cast<int>(at) : -1;
  }
  return nearest;
}

}  // namespace

PinholeCamera scaled_to(const PinholeCamera& camera, int width, int height) {
  SGS_CHECK(camera.width > 0 && camera.height > 0, "a camera without a size cannot be scaled");
  const double x = static_cast<double>(width) / camera.width;
  const double y = static_cast<double>(height) / camera.height;
  return {width,
          height,
          camera.fx * x,
          camera.fy * y,
          (camera.cx + 0.5) * x - 0.5,
          (camera.cy + 0.5) * y - 0.5};
}

PinholeCamera limited_to_width(const PinholeCamera& camera, int max_width) {
  if (max_width <= 0 || camera.width <= max_width) return camera;
  const int whole = (camera.width + max_width - 1) / max_width;
  const bool near = 4 * (camera.width / whole) >= 3 * max_width;
  const double factor = near ? whole : static_cast<double>(camera.width) / max_width;
  PinholeCamera out;
  // Both axes by the same factor: an incomplete last column or row is left out.
  out.width = static_cast<int>(camera.width / factor);
  out.height = std::max(1, static_cast<int>(camera.height / factor));
  out.fx = camera.fx / factor;
  out.fy = camera.fy / factor;
  out.cx = (camera.cx + 0.5) / factor - 0.5;
  out.cy = (camera.cy + 0.5) / factor - 0.5;
  return out;
}

ColorImage resample_color(const ColorImage& image, const PinholeCamera& from,
                          const PinholeCamera& to) {
  SGS_CHECK(image.width() == from.width && image.height() == from.height,
            "image size differs from the camera's");
  if (from == to) return image;
  keep_opencv_to_one_thread();
  // cv::Mat has no const view; the source is only read.
  cv::Mat source(image.height(), image.width(), CV_8UC3, const_cast<Rgb8*>(image.data()));
  const cv::Size reduced(reduced_size(from.width, from.fx / to.fx),
                         reduced_size(from.height, from.fy / to.fy));
  cv::Mat small = source;
  if (reduced != source.size()) cv::resize(source, small, reduced, 0, 0, cv::INTER_AREA);
  const PinholeCamera between = scaled_to(from, reduced.width, reduced.height);
  const AxisMap x = map_x(between, to), y = map_y(between, to);
  ColorImage out(to.width, to.height);
  cv::Mat target(to.height, to.width, CV_8UC3, out.data());
  const bool covers = reduced.width >= to.width && reduced.height >= to.height;
  if (covers && is_identity(x, to.width) && is_identity(y, to.height)) {
    small(cv::Rect(0, 0, to.width, to.height)).copyTo(target);
    return out;
  }
  const cv::Matx23d M(x.scale, 0, x.offset, 0, y.scale, y.offset);
  cv::warpAffine(small, target, M, target.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return out;
}

std::shared_ptr<const PixelMask> seen_by(const PinholeCamera& from, const PinholeCamera& to) {
  constexpr double kBorder_px = 0.51;  // half a pixel, and what does not show
  const AxisMap x = map_x(from, to), y = map_y(from, to);
  const auto sees = [](const AxisMap& map, int target, int size) {
    return map(target) >= -kBorder_px && map(target) <= size - 1 + kBorder_px;
  };
  if (sees(x, 0, from.width) && sees(x, to.width - 1, from.width) && sees(y, 0, from.height) &&
      sees(y, to.height - 1, from.height)) {
    return nullptr;
  }
  auto seen = std::make_shared<PixelMask>(to.width, to.height, std::uint8_t{0});
  for (int v = 0; v < to.height; ++v) {
    if (!sees(y, v, from.height)) continue;
    for (int u = 0; u < to.width; ++u) (*seen)(u, v) = sees(x, u, from.width);
  }
  return seen;
}

DepthImage resample_depth(const DepthImage& image, const PinholeCamera& from,
                          const PinholeCamera& to) {
  SGS_CHECK(image.width() == from.width && image.height() == from.height,
            "image size differs from the camera's");
  if (from == to) return image;
  const auto columns = nearest_pixels(map_x(from, to), from.width, to.width);
  const auto rows = nearest_pixels(map_y(from, to), from.height, to.height);
  DepthImage out(to.width, to.height);
  for (int v = 0; v < to.height; ++v) {
    const int row = rows[static_cast<std::size_t>(v)];
    if (row < 0) continue;
    for (int u = 0; u < to.width; ++u) {
      const int column = columns[static_cast<std::size_t>(u)];
      if (column >= 0) out(u, v) = image(column, row);
    }
  }
  return out;
}

namespace {

/// Which pixels of `to` show what `from` saw; `seen` are those of `from`, null for all.
std::shared_ptr<const PixelMask> seen_in(const PinholeCamera& from, const PinholeCamera& to,
                                         const std::shared_ptr<const PixelMask>& seen) {
  const auto inside = seen_by(from, to);
  if (!seen) return inside;
  auto both = std::make_shared<PixelMask>(to.width, to.height, std::uint8_t{0});
  for (int v = 0; v < to.height; ++v) {
    for (int u = 0; u < to.width; ++u) {
      if (inside && (*inside)(u, v) == 0) continue;
      const double x = (u - to.cx) / to.fx * from.fx + from.cx;
      const double y = (v - to.cy) / to.fy * from.fy + from.cy;
      (*both)(u, v) = (*seen)(std::clamp(static_cast<int>(std::lround(x)), 0, from.width - 1),
                              std::clamp(static_cast<int>(std::lround(y)), 0, from.height - 1));
    }
  }
  return both;
}

}  // namespace

RgbdFrame resampled(RgbdFrame frame, const PinholeCamera& to) {
  const PinholeCamera from = std::exchange(frame.camera, to);
  if (from == to) return frame;
  frame.seen = seen_in(from, to, frame.seen);
  frame.color = resample_color(frame.color, from, to);
  frame.depth = resample_depth(frame.depth, from, to);
  return frame;
}

}  // namespace sgs
