// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV's RGB-D odometry (contrib module rgbd) frame to frame on a recorded sequence, scored like
// our own runs: the yardstick of docs/accuracy.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/depth.hpp>
#include <string>
#include <vector>

#include "sgs/dataset/open.h"
#include "sgs/eval/trajectory_metrics.h"

namespace {

struct Views {
  cv::Mat gray, depth;
};

Views to_views(const sgs::RgbdFrame& frame) {
  Views views;
  cv::Mat color(frame.color.height(), frame.color.width(), CV_8UC3);
  views.depth.create(frame.depth.height(), frame.depth.width(), CV_32FC1);
  for (int y = 0; y < color.rows; ++y) {
    for (int x = 0; x < color.cols; ++x) {
      const sgs::Rgb8& c = frame.color(x, y);
      color.at<cv::Vec3b>(y, x) = {c.b, c.g, c.r};
      const float z = frame.depth(x, y);
      views.depth.at<float>(y, x) = z > 0 ? z : std::numeric_limits<float>::quiet_NaN();
    }
  }
  cv::cvtColor(color, views.gray, cv::COLOR_BGR2GRAY);
  return views;
}

sgs::SE3 to_se3(const cv::Mat& m) {
  sgs::SE3 T;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) T.R(r, c) = m.at<double>(r, c);
    T.t(r) = m.at<double>(r, 3);
  }
  return T;
}

double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: {} RgbdOdometry|ICPOdometry|RgbdICPOdometry SEQUENCE\n", argv[0]);
    return 2;
  }
  cv::setNumThreads(1);
  auto sequence = sgs::dataset::open_sequence(argv[2]);
  if (!sequence) {
    fmt::print(stderr, "{}\n", sequence.error().text());
    return 1;
  }
  const sgs::PinholeCamera camera = sequence->frames->camera();
  const auto odometry = cv::rgbd::Odometry::create(argv[1]);
  odometry->setCameraMatrix(
      cv::Mat(cv::Matx33d(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1)));
  cv::Ptr<cv::rgbd::OdometryFrame> last;
  sgs::SE3 T_world_camera;
  std::vector<sgs::eval::PoseEstimate> estimates;
  sgs::RgbdFrame frame;
  sgs::Error error;
  int failed = 0;
  double spent_ms = 0;
  for (;;) {
    const auto read = sequence->frames->next(frame, error);
    if (read == sgs::dataset::FrameRead::kEnd) break;
    if (read == sgs::dataset::FrameRead::kBadFrame) continue;
    const Views views = to_views(frame);
    const double start = cpu_ms();
    auto current = cv::rgbd::OdometryFrame::create(views.gray, views.depth);
    cv::Mat Rt;
    if (last) {
      // Rt takes points of the first frame to the second.
      if (odometry->compute(last, current, Rt) && !Rt.empty()) {
        T_world_camera = T_world_camera * to_se3(Rt).inverse();
      } else {
        ++failed;
      }
    }
    spent_ms += cpu_ms() - start;
    last = current;
    estimates.push_back({frame.index, frame.timestamp_s, T_world_camera, false});
  }
  const auto metrics =
      sgs::eval::evaluate_trajectory(estimates, sequence->frames->ground_truth(), {});
  fmt::print("{:<18} {}  ATE {:.2f} cm  {} of {} frames failed  {:.1f} ms CPU per frame\n", argv[1],
             argv[2], metrics.ate ? 100 * metrics.ate->rmse : NAN, failed, estimates.size(),
             spent_ms / static_cast<double>(std::max<std::size_t>(1, estimates.size())));
  return 0;
}
