// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV's RGB-D odometry (contrib module rgbd) frame to frame on a recorded sequence.
#include <fmt/format.h>

#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/depth.hpp>
#include <string>

#include "frame_odometry.h"

namespace {

cv::Ptr<cv::rgbd::OdometryFrame> to_odometry_frame(const sgs::RgbdFrame& frame) {
  cv::Mat color(frame.color.height(), frame.color.width(), CV_8UC3);
  cv::Mat depth(frame.depth.height(), frame.depth.width(), CV_32FC1), gray;
  for (int y = 0; y < color.rows; ++y) {
    for (int x = 0; x < color.cols; ++x) {
      const sgs::Rgb8& c = frame.color(x, y);
      color.at<cv::Vec3b>(y, x) = {c.b, c.g, c.r};
      const float z = frame.depth(x, y);
      depth.at<float>(y, x) = z > 0 ? z : std::numeric_limits<float>::quiet_NaN();
    }
  }
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  return cv::rgbd::OdometryFrame::create(gray, depth);
}

sgs::SE3 to_se3(const cv::Mat& m) {
  sgs::SE3 T;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) T.R(r, c) = m.at<double>(r, c);
    T.t(r) = m.at<double>(r, 3);
  }
  return T;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: {} RgbdOdometry|ICPOdometry|RgbdICPOdometry SEQUENCE\n", argv[0]);
    return 2;
  }
  cv::setNumThreads(1);
  const std::string method = argv[1];
  return sgs::bench::run_frame_odometry(method, argv[2], [&](const sgs::PinholeCamera& camera) {
    const auto odometry = cv::rgbd::Odometry::create(method);
    odometry->setCameraMatrix(
        cv::Mat(cv::Matx33d(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1)));
    return [odometry, last = cv::Ptr<cv::rgbd::OdometryFrame>()](
               const sgs::RgbdFrame& frame) mutable -> std::optional<sgs::SE3> {
      auto before = std::exchange(last, to_odometry_frame(frame));
      cv::Mat Rt;  // takes points of the frame before to this one
      if (!before || !odometry->compute(before, last, Rt) || Rt.empty()) return std::nullopt;
      return to_se3(Rt).inverse();
    };
  });
}
