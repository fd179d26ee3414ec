// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// PCL's generalized ICP frame to frame on a recorded sequence, on the points of a pixel grid.
#include <fmt/format.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>

#include <charconv>
#include <cstring>
#include <string>

#include "frame_odometry.h"

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

Cloud::Ptr to_cloud(const sgs::RgbdFrame& frame, int step) {
  const sgs::PinholeCamera& c = frame.camera;
  auto cloud = std::make_shared<Cloud>();
  for (int v = step / 2; v < c.height; v += step) {
    for (int u = step / 2; u < c.width; u += step) {
      const float z = frame.depth(u, v);
      if (!(z > 0)) continue;
      cloud->push_back({z * static_cast<float>((u - c.cx) / c.fx),
                        z * static_cast<float>((v - c.cy) / c.fy), z});
    }
  }
  return cloud;
}

}  // namespace

int main(int argc, char** argv) {
  int step = 8;
  if (argc < 2 || argc > 3 ||
      (argc == 3 &&
       (std::from_chars(argv[2], argv[2] + std::strlen(argv[2]), step).ec != std::errc{} ||
        step < 1))) {
    fmt::print(stderr, "usage: {} SEQUENCE [PIXELS BETWEEN POINTS, 8]\n", argv[0]);
    return 2;
  }
  return sgs::bench::run_frame_odometry("PCL G-ICP", argv[1], [&](const sgs::PinholeCamera&) {
    return [step,
            last = Cloud::Ptr()](const sgs::RgbdFrame& frame) mutable -> std::optional<sgs::SE3> {
      const auto before = std::exchange(last, to_cloud(frame, step));
      constexpr std::size_t kFewest = 100;
      if (!before || before->size() < kFewest || last->size() < kFewest) return std::nullopt;
      pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> gicp;
      gicp.setMaxCorrespondenceDistance(0.1);
      gicp.setInputSource(last);
      gicp.setInputTarget(before);
      Cloud moved;
      gicp.align(moved);
      if (!gicp.hasConverged()) return std::nullopt;
      const Eigen::Matrix4d T = gicp.getFinalTransformation().cast<double>();
      sgs::SE3 T_last_current;
      T_last_current.R = T.topLeftCorner<3, 3>();
      T_last_current.t = T.topRightCorner<3, 1>();
      return T_last_current;
    };
  });
}
