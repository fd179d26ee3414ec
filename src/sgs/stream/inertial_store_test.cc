// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/inertial_store.h"

#include <gtest/gtest.h>

namespace sgs::stream {
namespace {

TEST(InertialStore, KeepsMeansWhateverTheRate) {
  Hello hello;
  hello.T_color_imu = SE3();
  InertialStore store;
  EXPECT_TRUE(store.recording("camera").source.empty());
  std::vector<InertialSample> samples;
  for (int i = 0; i < 400; ++i) {
    InertialSample sample{i / 400.0};
    (i % 2 == 0 ? sample.acceleration_m_s2 : sample.angular_velocity_rad_s) = {0, -9.81, 1};
    samples.push_back(sample);
  }
  store.add(samples, 100, hello);
  const auto recording = store.recording("camera");
  EXPECT_EQ(recording.source, "camera");
  EXPECT_TRUE(recording.R_camera_imu);
  EXPECT_NEAR(static_cast<double>(recording.samples.size()), 24, 1);
  double before_s = 99.9;
  for (const ImuSample& sample : recording.samples) {
    EXPECT_GT(sample.timestamp_s, before_s);
    before_s = sample.timestamp_s;
    EXPECT_NEAR((sample.acceleration - Eigen::Vector3d(0, -9.81, 1)).norm(), 0, 1e-12);
  }
}

TEST(InertialStore, TimesThatGoBackAreLeftOut) {
  InertialStore store;
  const auto at = [](double t) { return InertialSample{t, {}, {1, 2, 3}}; };
  const std::vector<InertialSample> samples = {at(10), at(11), at(5), at(12), at(13)};
  store.add(samples, 0, {});
  EXPECT_EQ(store.recording("").samples.size(), 3u);
}

}  // namespace
}  // namespace sgs::stream
