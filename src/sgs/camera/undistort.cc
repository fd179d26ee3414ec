// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/undistort.h"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "sgs/camera/opencv_threads.h"

namespace sgs {

struct Undistorter::Maps {
  cv::Size size;
  cv::Mat bilinear_xy, bilinear_weights;  // OpenCV's fixed-point maps for colour
  cv::Mat nearest_xy;                     // CV_32FC2 for depth
};

namespace {

/// Where each pixel of the picture without distortion lies in the one with it.
cv::Mat sources(const PinholeCamera& camera, const Distortion& d) {
  cv::Mat xy;
  if (!d.is_fisheye()) {
    const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
    const cv::Matx<double, 8, 1> D(d.coefficients().data());
    cv::Mat unused;
    cv::initUndistortRectifyMap(K, D, cv::noArray(), K, {camera.width, camera.height}, CV_32FC2, xy,
                                unused);
    return xy;
  }
  xy.create(camera.height, camera.width, CV_32FC2);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto bent = d.apply({(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy});
      xy.at<cv::Vec2f>(v, u) = {static_cast<float>(camera.fx * bent.x() + camera.cx),
                                static_cast<float>(camera.fy * bent.y() + camera.cy)};
    }
  }
  return xy;
}

/// Beyond the fold the formula leads back into the picture, to what is shown elsewhere already:
/// such pixels get a source outside it.
void forget_beyond_fold(const PinholeCamera& camera, const Distortion& distortion, cv::Mat& xy) {
  constexpr float kOutside_px = -10;
  const double fold = distortion.fold_radius();
  if (std::isinf(fold)) return;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double radius = std::hypot((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
      if (radius >= fold) xy.at<cv::Vec2f>(v, u) = {kOutside_px, kOutside_px};
    }
  }
}

/// Which pixels of `camera` have a source, as `xy` says, in a picture of the same size.
std::shared_ptr<const PixelMask> pixels_with_source(const PinholeCamera& camera,
                                                    const cv::Mat& xy) {
  constexpr float kRounding_px = 0.01f;
  auto seen = std::make_shared<PixelMask>(camera.width, camera.height, std::uint8_t{0});
  bool all = true;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto& from = xy.at<cv::Vec2f>(v, u);
      const bool inside = from[0] >= -kRounding_px && from[1] >= -kRounding_px &&
                          from[0] <= static_cast<float>(camera.width - 1) + kRounding_px &&
                          from[1] <= static_cast<float>(camera.height - 1) + kRounding_px;
      (*seen)(u, v) = inside;
      all = all && inside;
    }
  }
  return all ? nullptr : seen;
}

}  // namespace

Undistorter::Undistorter(const PinholeCamera& camera, const Distortion& d) {
  keep_opencv_to_one_thread();
  auto maps = std::make_unique<Maps>();
  maps->size = {camera.width, camera.height};
  maps->nearest_xy = sources(camera, d);
  forget_beyond_fold(camera, d, maps->nearest_xy);
  cv::convertMaps(maps->nearest_xy, cv::noArray(), maps->bilinear_xy, maps->bilinear_weights,
                  CV_16SC2);
  seen_ = pixels_with_source(camera, maps->nearest_xy);
  maps_ = std::move(maps);
}

Undistorter::~Undistorter() = default;
Undistorter::Undistorter(Undistorter&&) noexcept = default;
Undistorter& Undistorter::operator=(Undistorter&&) noexcept = default;

ColorImage Undistorter::color(const ColorImage& distorted) const {
  SGS_CHECK(distorted.width() == maps_->size.width && distorted.height() == maps_->size.height,
            "image size differs from the calibration");
  ColorImage out(distorted.width(), distorted.height());
  // cv::Mat has no const view; the source is only read.
  const cv::Mat in(maps_->size, CV_8UC3, const_cast<Rgb8*>(distorted.data()));
  cv::Mat result(maps_->size, CV_8UC3, out.data());
  cv::remap(in, result, maps_->bilinear_xy, maps_->bilinear_weights, cv::INTER_LINEAR,
            cv::BORDER_CONSTANT);
  return out;
}

PixelMask Undistorter::mask(const PixelMask& distorted) const {
  SGS_CHECK(distorted.width() == maps_->size.width && distorted.height() == maps_->size.height,
            "mask size differs from the calibration");
  PixelMask out(distorted.width(), distorted.height());
  const cv::Mat in(maps_->size, CV_8U, const_cast<std::uint8_t*>(distorted.data()));
  cv::Mat result(maps_->size, CV_8U, out.data());
  cv::remap(in, result, maps_->nearest_xy, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  for (std::size_t i = 0; seen_ && i < out.size(); ++i) out.data()[i] &= seen_->data()[i];
  return out;
}

DepthImage Undistorter::depth(const DepthImage& distorted) const {
  SGS_CHECK(distorted.width() == maps_->size.width && distorted.height() == maps_->size.height,
            "image size differs from the calibration");
  DepthImage out(distorted.width(), distorted.height());
  const cv::Mat in(maps_->size, CV_32F, const_cast<float*>(distorted.data()));
  cv::Mat result(maps_->size, CV_32F, out.data());
  cv::remap(in, result, maps_->nearest_xy, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  return out;
}

}  // namespace sgs
