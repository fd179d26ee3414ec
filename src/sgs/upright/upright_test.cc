// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/upright/upright.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/upright/gravity.h"

namespace sgs::run {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kGravity = 9.81;

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return 180 / std::numbers::pi * std::atan2(a.cross(b).norm(), a.dot(b));
}

/// A level room in the world of a first camera that looks down by 35 degrees and is rolled a bit: a
/// path that turns, what an accelerometer feels on it, and the surfaces that are seen.
class Tilted : public ::testing::Test {
 protected:
  Tilted() {
    for (int i = 0; i <= 300; ++i) {
      const double t = i / 30.0;
      const Eigen::Vector3d turn(0.3 * std::sin(1.1 * t), 0.6 * std::sin(0.7 * t),
                                 0.2 * std::sin(1.7 * t));
      path_.push_back({100 + t, SE3(so3_exp(turn), position(t))});
    }
  }
  static Eigen::Vector3d position(double t) {
    return {0.3 * std::sin(2 * t), 0.1 * std::cos(3 * t) - 0.1, 0.2 * std::sin(1.3 * t)};
  }
  /// Feels gravity and the hand's motion with noise and a bias, in axes that `R_camera_imu` turns
  /// into the camera's.
  dataset::ImuRecording felt(const Eigen::Matrix3d& R_camera_imu, double unit = 1) {
    dataset::ImuRecording imu{"acc.txt", {}, R_camera_imu, {}};
    std::mt19937 generator(3);
    std::normal_distribution<double> noise(0, 0.3);
    constexpr double h = 0.01;
    for (double t = 0.05; t < 9.9; t += 0.002) {
      const Eigen::Vector3d motion =
          (position(t + h) - 2 * position(t) + position(t - h)) / (h * h);
      const Eigen::Matrix3d R_world_camera = path_.at(100 + t, 0.1)->R;
      Eigen::Vector3d a =
          R_camera_imu.transpose() * R_world_camera.transpose() * (kGravity * up_ + motion);
      a += Eigen::Vector3d(noise(generator), noise(generator), noise(generator));
      imu.samples.push_back({100 + t, a / unit, {}});
    }
    return imu;
  }
  /// Walls and clutter, and a floor of that share of the area whose measured normals scatter.
  std::vector<Patch> room(double floor_share, const Eigen::Vector3d& floor_normal) const {
    std::vector<Patch> patches;
    std::mt19937 generator(4);
    std::normal_distribution<double> noise(0, 1);
    const auto random = [&] {
      return Eigen::Vector3d(noise(generator), noise(generator), noise(generator));
    };
    const Eigen::Vector3d wall = floor_normal.unitOrthogonal();
    constexpr int kPatches = 3000;
    for (int i = 0; i < kPatches; ++i) {
      const double what = static_cast<double>(i) / kPatches;
      Eigen::Vector3d normal = random();
      if (what < floor_share) {
        normal = floor_normal + 0.03 * random();
      } else if (what < floor_share + 0.4) {
        normal = wall + 0.03 * random();
      }
      patches.push_back({normal.normalized(), 1});
    }
    return patches;
  }
  Upright find(const dataset::ImuRecording& imu, const std::vector<Patch>& patches) {
    warnings_.clear();
    const auto upright = find_upright(imu, path_, patches, warnings_);
    EXPECT_TRUE(upright);
    return *upright;
  }

  const Eigen::Vector3d up_ = Eigen::Vector3d(0.1, -0.81, -0.57).normalized();
  const Eigen::Matrix3d kinect_ = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  Trajectory path_;
  std::vector<std::string> warnings_;
};

TEST_F(Tilted, AnAccelerometerSaysWhatIsUp) {
  const Upright upright = find(felt(kinect_), {});
  EXPECT_EQ(upright.by, UprightBy::kAccelerometer);
  EXPECT_LT(angle_deg(upright.up, up_), 1);
  EXPECT_THAT(warnings_, IsEmpty());
  EXPECT_TRUE((upright.T_upright_world.R * upright.up).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_NEAR(upright.T_upright_world.R.determinant(), 1, 1e-9);
  // The first camera looks along x, and down.
  const Eigen::Vector3d ahead = upright.T_upright_world.R * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(ahead.y(), 0, 1e-9);
  EXPECT_GT(ahead.x(), 0.5);
  EXPECT_LT(ahead.z(), -0.3);
}

TEST_F(Tilted, LevelSurfacesMakeItExact) {
  const Eigen::Vector3d bias = 0.06 * up_.unitOrthogonal();
  dataset::ImuRecording imu = felt(kinect_);
  for (std::size_t i = 0; i < imu.samples.size(); ++i) {
    const Eigen::Matrix3d R = path_.at(imu.samples[i].timestamp_s, 0.1)->R;
    imu.samples[i].acceleration += kinect_.transpose() * R.transpose() * (kGravity * bias);
  }
  EXPECT_GT(angle_deg(find(imu, {}).up, up_), 3);
  const Upright upright = find(imu, room(0.2, up_));
  EXPECT_EQ(upright.by, UprightBy::kAccelerometerAndFloor);
  EXPECT_LT(angle_deg(upright.up, up_), 0.5);
  // Stairs and roofs are no floors.
  const Eigen::Vector3d slope = so3_exp(0.4 * up_.unitOrthogonal()) * up_;
  EXPECT_EQ(find(felt(kinect_), room(0.2, slope)).by, UprightBy::kAccelerometer);
}

TEST_F(Tilted, WithoutAnAccelerometerTheFloorDoes) {
  const Upright upright = find({}, room(0.2, up_));
  EXPECT_EQ(upright.by, UprightBy::kFloor);
  EXPECT_LT(angle_deg(upright.up, up_), 0.5);
  EXPECT_THAT(upright.sentence(), HasSubstr("floor"));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Tilted, WithoutEitherTheCameraIsTakenAsHeldUpright) {
  EXPECT_EQ(find({}, room(0, up_)).by, UprightBy::kCamera);
  const Upright upright = find({}, {});
  EXPECT_EQ(upright.by, UprightBy::kCamera);
  EXPECT_LT(angle_deg(upright.up, -Eigen::Vector3d::UnitY()), 20);
  std::vector<std::string> warnings;
  EXPECT_FALSE(find_upright({}, {}, {}, warnings));
}

TEST_F(Tilted, OtherUnitsAreRecognisedByTheirLength) {
  for (const auto& [unit, said] :
       {std::pair(kGravity, "in g, not m/s2"), std::pair(kGravity / 1000, "in thousandths of g"),
        std::pair(kGravity / 819, "in an unknown unit")}) {
    const Upright upright = find(felt(kinect_, unit), {});
    EXPECT_LT(angle_deg(upright.up, up_), 1);
    EXPECT_THAT(warnings_, ElementsAre(AllOf(HasSubstr("acc.txt: lengths of"), HasSubstr(said),
                                             HasSubstr("Multiply the values by"))));
  }
  find(felt(kinect_, kGravity), {});
  EXPECT_THAT(warnings_[0], HasSubstr("Multiply the values by 9.806"));
}

TEST_F(Tilted, AnotherClockIsTold) {
  dataset::ImuRecording imu = felt(kinect_);
  for (ImuSample& sample : imu.samples) sample.timestamp_s += 1e6;
  EXPECT_EQ(find(imu, room(0.2, up_)).by, UprightBy::kFloor);
  EXPECT_THAT(warnings_, ElementsAre(AllOf(HasSubstr("from 1000100.05"), HasSubstr("on one clock"),
                                           HasSubstr("it is not used"))));
}

TEST_F(Tilted, MotionWithoutGravityIsNotUsed) {
  dataset::ImuRecording imu = felt(kinect_);
  std::mt19937 generator(5);
  std::normal_distribution<double> noise(0, 1);
  for (ImuSample& sample : imu.samples) {
    sample.acceleration = {std::pow(noise(generator), 3), std::pow(noise(generator), 3), 0};
  }
  EXPECT_EQ(find(imu, room(0.2, up_)).by, UprightBy::kFloor);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("not those of gravity")));
  for (ImuSample& sample : imu.samples) sample.acceleration.setZero();
  EXPECT_EQ(find(imu, {}).by, UprightBy::kCamera);
}

TEST_F(Tilted, OneThatFeelsDownwardsIsTurnedRoundWhereTheFloorContradictsIt) {
  dataset::ImuRecording imu = felt(kinect_);
  for (ImuSample& sample : imu.samples) sample.acceleration *= -1;
  const Upright upright = find(imu, room(0.2, up_));
  EXPECT_LT(angle_deg(upright.up, up_), 0.5);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("acc.txt: it feels gravity upside down")));
  // Nothing contradicts it: the camera may hang from a ceiling.
  EXPECT_LT(angle_deg(find(imu, {}).up, -up_), 1);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("the camera hangs upside down, and no floor")));
  // A floor on the side that it calls down agrees with it.
  EXPECT_LT(angle_deg(find(imu, room(0.2, -up_)).up, -up_), 1);
}

TEST_F(Tilted, AMountingThatIsNotTheUsualOneIsFoundOnAPathThatTurns) {
  Eigen::Matrix3d optical;  // axes of ROS bodies: x forward, y left, z up
  optical << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  dataset::ImuRecording imu = felt(optical);
  imu.R_camera_imu = kinect_;
  EXPECT_LT(angle_deg(find(imu, {}).up, up_), 1);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("in others")));
  imu.R_camera_imu.reset();
  EXPECT_LT(angle_deg(find(imu, {}).up, up_), 1);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Tilted, OnAPathThatDoesNotTurnAnUnknownMountingIsTheOneThatHoldsTheCameraUpright) {
  std::vector<StampedPose> still = path_.poses();
  for (StampedPose& pose : still) pose.T_world_camera.R.setIdentity();
  path_ = Trajectory(still);
  dataset::ImuRecording imu = felt(kinect_);
  imu.R_camera_imu.reset();
  EXPECT_LT(angle_deg(find(imu, {}).up, up_), 90 - 35);
}

TEST_F(Tilted, AtTheStartItIsWhatIsFeltThen) {
  const dataset::ImuRecording imu = felt(kinect_);
  const auto up = felt_up(imu, 100);
  ASSERT_TRUE(up);
  EXPECT_LT(angle_deg(*up, up_), 15);
  EXPECT_FALSE(felt_up(imu, 500));
  EXPECT_FALSE(felt_up({}, 100));
}

TEST_F(Tilted, ASceneWithoutSurfacesHasNoneThatIsLevel) {
  EXPECT_FALSE(find_level_surfaces(room(0, up_), up_, 20));
  EXPECT_FALSE(find_level_surfaces({}, up_, 50));
  const auto level = find_level_surfaces(room(0.1, up_), -Eigen::Vector3d::UnitY(), 50);
  ASSERT_TRUE(level);
  EXPECT_NEAR(level->share, 0.1, 0.03);
}

TEST_F(Tilted, TheFileComesBackAsItWas) {
  const io::TemporaryFolder folder;
  const auto path = folder.path() / "upright.toml";
  const Upright upright = find({}, room(0.2, up_));
  ASSERT_TRUE(save_upright(path, upright));
  const auto loaded = load_upright(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->by, UprightBy::kFloor);
  EXPECT_TRUE(loaded->up.isApprox(upright.up, 1e-6));
  EXPECT_TRUE(loaded->T_upright_world.R.isApprox(upright.T_upright_world.R, 1e-6));
  const std::string written = io::read_file(path).value();
  ASSERT_TRUE(save_upright(path, *loaded));
  EXPECT_EQ(io::read_file(path).value(), written);
  for (const char* text : {"format = 2\n", "format = 1\nby = 'hope'\n", "format = 1\n", "junk",
                           "format = 1\n[up]\nx = 0\ny = 0\nz = 1\n[T_upright_world]\nqx = 1\n"}) {
    ASSERT_TRUE(io::write_file(path, text));
    const auto bad = load_upright(path);
    ASSERT_FALSE(bad) << text;
    EXPECT_THAT(bad.error().text(), HasSubstr("upright.toml"));
  }
}

}  // namespace
}  // namespace sgs::run
