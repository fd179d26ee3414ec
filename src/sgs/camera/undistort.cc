// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/undistort.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "sgs/camera/opencv_threads.h"

namespace sgs {

struct Undistorter::Maps {
  cv::Size size;
  cv::Mat bilinear_xy, bilinear_weights;  // OpenCV's fixed-point maps for colour
  cv::Mat nearest_xy;                     // CV_32FC2 for depth
};

Undistorter::Undistorter(const PinholeCamera& camera, const Distortion& d) {
  keep_opencv_to_one_thread();
  auto maps = std::make_unique<Maps>();
  maps->size = {camera.width, camera.height};
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Matx<double, 8, 1> D(d.coefficients().data());
  cv::Mat map_x;
  cv::initUndistortRectifyMap(K, D, cv::noArray(), K, maps->size, CV_32FC2, maps->nearest_xy,
                              map_x);
  cv::convertMaps(maps->nearest_xy, cv::noArray(), maps->bilinear_xy, maps->bilinear_weights,
                  CV_16SC2);
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
