// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/given_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/dataset/open.h"
#include "sgs/dataset/tum_writer.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/colmap.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

SE3 pose_at(double x_m) { return {so3_exp({0, 0, 0.1 * x_m}), {x_m, 0, 0}}; }

Trajectory poses_at(const std::vector<double>& times_s) {
  Trajectory poses;
  for (const double time_s : times_s) poses.push_back({time_s, pose_at(time_s)});
  return poses;
}

TEST(GivenPoseAt, InterpolatesOverAQuarterOfASecondAndTakesWhatIsVeryNear) {
  const Trajectory poses = poses_at({1, 1.2, 2});
  EXPECT_NEAR(given_pose_at(poses, 1.1)->t.x(), 1.1, 1e-12);
  EXPECT_FALSE(given_pose_at(poses, 1.6));
  EXPECT_EQ(given_pose_at(poses, 1.201)->t.x(), 1.2);
  EXPECT_EQ(given_pose_at(poses, 1.9985)->t.x(), 2);
  EXPECT_EQ(given_pose_at(poses, 0.999)->t.x(), 1);
  EXPECT_EQ(given_pose_at(poses, 2.001)->t.x(), 2);
  EXPECT_FALSE(given_pose_at(poses, 0.99));
  EXPECT_FALSE(given_pose_at(poses, 2.01));
  EXPECT_FALSE(given_pose_at(Trajectory{}, 1));
}

/// A sequence of four frames at 100, 100.5, 101 and 101.5 s, and files of poses for it.
class GivenPosesOfAFolder : public testing::Test {
 protected:
  void SetUp() override {
    auto writer = TumSequenceWriter::create(folder(), camera_);
    ASSERT_TRUE(writer) << writer.error().text();
    for (int i = 0; i < 4; ++i) {
      RgbdFrame frame;
      frame.timestamp_s = 100 + 0.5 * i;
      frame.camera = camera_;
      frame.color = ColorImage(32, 24, {90, 100, 50});
      frame.depth = DepthImage(32, 24, 2.0f);
      if (truth_) frame.truth_T_world_camera = pose_at(i);
      ASSERT_TRUE(writer->add(frame));
    }
  }
  fs::path folder() const { return temporary_ / "sequence"; }
  std::string put(const fs::path& name, const std::string& text) const {
    EXPECT_TRUE(io::write_file(temporary_ / name, text));
    return (temporary_ / name).string();
  }
  /// Given x position per frame, "-" where it is a bad frame; or the error.
  std::string read(const std::string& poses) const {
    OpenOptions options;
    options.poses = poses;
    auto sequence = open_sequence(folder(), options);
    if (!sequence) return sequence.error().text();
    std::string out;
    RgbdFrame frame;
    Error error;
    for (;;) {
      const FrameRead read = sequence->frames->next(frame, error);
      if (read == FrameRead::kEnd) return out;
      const bool given = read == FrameRead::kOk && frame.given_T_world_camera;
      out += given ? fmt::format("{:.3g} ", frame.given_T_world_camera->t.x()) : "- ";
    }
  }
  /// images.txt with these names, at x = 10, 11, ...
  std::string colmap(const std::vector<std::string>& names) const {
    std::vector<io::ColmapImage> images;
    for (const std::string& name : names) {
      images.push_back({name, pose_at(10.0 + static_cast<double>(images.size()))});
    }
    EXPECT_TRUE(io::save_colmap_model(temporary_ / "model", camera_, images, {}));
    return (temporary_ / "model").string();
  }

  const io::TemporaryFolder temporary_;
  const PinholeCamera camera_{32, 24, 30, 30, 15.5, 11.5};
  bool truth_ = true;
};

class GivenPosesOfAFolderWithoutAny : public GivenPosesOfAFolder {
 protected:
  GivenPosesOfAFolderWithoutAny() { truth_ = false; }
};

TEST_F(GivenPosesOfAFolder, NobodyAskedForThem) {
  auto sequence = open_sequence(folder());
  ASSERT_TRUE(sequence);
  RgbdFrame frame;
  Error error;
  ASSERT_EQ(sequence->frames->next(frame, error), FrameRead::kOk);
  EXPECT_FALSE(frame.given_T_world_camera);
}

TEST_F(GivenPosesOfAFolder, OfTheRecordingItself) { EXPECT_EQ(read(kRecordedPoses), "0 1 2 3 "); }

TEST_F(GivenPosesOfAFolderWithoutAny, AreAnErrorThatNamesTheFlag) {
  EXPECT_THAT(read(kRecordedPoses), HasSubstr("no poses of its own"));
  EXPECT_THAT(read(kRecordedPoses), HasSubstr("--poses takes TUM rows"));
}

TEST_F(GivenPosesOfAFolder, OfATumFileAndFramesWithoutOneAreBad) {
  const auto poses = put("p.txt", "100 7 0 0 0 0 0 1\n101.0004 8 0 0 0 0 0 1\n");
  EXPECT_EQ(read(poses), "7 - 8 - ");
}

TEST_F(GivenPosesOfAFolder, ATumFileOfOtherTimesIsRefusedAndSaysBoth) {
  const auto other = read(put("p.txt", "5 0 0 0 0 0 0 1\n6 0 0 0 0 0 0 1\n"));
  EXPECT_THAT(other, HasSubstr("2 poses from 5.000 to 6.000 s"));
  EXPECT_THAT(other, HasSubstr("from 100.000 to 101.500 s"));
  EXPECT_THAT(other, HasSubstr("clock of the recording"));
  EXPECT_THAT(read(put("p.txt", "100000000000 0 0 0 0 0 0 1\n")), HasSubstr("nanoseconds"));
  // Within the recording, but at the time of no frame.
  EXPECT_THAT(read(put("p.txt", "100.2 0 0 0 0 0 0 1\n")), HasSubstr("no pose is of the time"));
}

TEST_F(GivenPosesOfAFolder, WhatHoldsNoPosesIsRefused) {
  EXPECT_THAT(read((temporary_ / "none.txt").string()), HasSubstr("none.txt"));
  EXPECT_THAT(read(put("p.txt", "1 2 3\n")), HasSubstr("images.txt of a COLMAP"));
  EXPECT_THAT(read(put("p.txt", "100 0 0 0 0 0 0 2\n")), HasSubstr("no rotations"));
  EXPECT_THAT(read(put("p.txt", "100 0 0 0 nan 0 0 1\n")), HasSubstr("no usable pose in 1 rows"));
  EXPECT_THAT(read(temporary_.path().string()), HasSubstr("neither images.txt nor"));
  EXPECT_THAT(read(put("p.txt", "100 431000 5400000 0 0 0 0 1\n")), HasSubstr("from the origin"));
}

TEST_F(GivenPosesOfAFolder, OfAColmapModelGoByName) {
  EXPECT_EQ(read(colmap({"100.500000.png", "rgb/101.500000.png"})), "- 10 - 11 ");
  // Undistorted or reduced copies may have another extension.
  EXPECT_EQ(read(colmap({"100.000000.jpg"}) + "/images.txt"), "10 - - - ");
  EXPECT_THAT(read(colmap({"a.png", "b.png"})), HasSubstr("none of its 2 pictures ('a.png'"));
  EXPECT_THAT(read(colmap({"depth/100.000000.png"})), HasSubstr("none of its 1 pictures"));
}

TEST_F(GivenPosesOfAFolder, ABinaryModelNamesTheConverter) {
  EXPECT_TRUE(io::make_folder(temporary_ / "binary"));
  put("binary/images.bin", "x");
  EXPECT_THAT(read((temporary_ / "binary").string()), HasSubstr("model_converter"));
}

/// A camera that moves sideways in front of a wall, and a model of it in another unit.
class GivenPosesInAnotherUnit : public GivenPosesOfAFolder {
 protected:
  /// Writes a model whose unit is `metres`, with points on the wall, 2 m away.
  std::string model(double metres, int points_per_side) const {
    std::string images, points;
    const int count = points_per_side * points_per_side;
    for (int i = 0; i < 4; ++i) {
      // The camera of frame i stands at x = 0.1 (i + 1) metres.
      images += fmt::format("{} 1 0 0 0 {} 0 0 1 {:.6f}.png\n", i + 1, -0.1 * (i + 1) / metres,
                            100 + 0.5 * i);
      for (int p = 0; p < count; ++p) images += fmt::format("0 0 {} ", p);
      images += "5 5 -1\n";
    }
    for (int p = 0; p < count; ++p) {
      const double x = 0.02 * (p % points_per_side), y = 0.02 * (p / points_per_side);
      points += fmt::format("{} {} {} {} 9 9 9 0.5 1 0\n", p, x / metres, y / metres, 2 / metres);
    }
    put("model/images.txt", images);
    put("model/points3D.txt", points);
    return (temporary_ / "model").string();
  }
};

TEST_F(GivenPosesInAnotherUnit, AreBroughtToMetresByTheMeasuredDepths) {
  EXPECT_EQ(read(model(0.25, 10)), "0.1 0.2 0.3 0.4 ");
  // As good as metres: exact poses stay what they are.
  EXPECT_EQ(read(model(1.01, 10)), "0.099 0.198 0.297 0.396 ");
}

TEST_F(GivenPosesInAnotherUnit, TooFewPointsTellNothing) {
  EXPECT_EQ(read(model(0.25, 2)), "0.4 0.8 1.2 1.6 ");
}

TEST_F(GivenPosesInAnotherUnit, ADamagedModelNamesItsLine) {
  const std::string folder = model(0.25, 4);
  put("model/points3D.txt", "1 2 3\n");
  EXPECT_THAT(read(folder), HasSubstr("points3D.txt:1: not a point"));
  put("model/images.txt", "1 1 0 0 0 0 0 0 1 100.000000.png\n1 2 x\n");
  EXPECT_THAT(read(folder), HasSubstr("images.txt:2: 'x' is no number of a point"));
}

TEST(GivenPoses, ByNameNeedNames) {
  const io::TemporaryFolder temporary;
  ASSERT_TRUE(io::save_colmap_model(temporary.path(), {32, 24, 30, 30, 15.5, 11.5},
                                    std::vector<io::ColmapImage>{{"a.png", SE3{}}}, {}));
  const auto poses = load_given_poses(temporary.path().string(), {}, {"a.bag", 0, 1, {}});
  ASSERT_FALSE(poses);
  EXPECT_THAT(poses.error().text(), HasSubstr("the images of a.bag have none"));
}

TEST(GivenPoses, WhereOnlyTheEndsAreKnownTheTimesMustMeet) {
  EXPECT_TRUE(load_given_poses(kRecordedPoses, poses_at({1, 2}), {"a.bag", 1.5, 9, {}}));
  EXPECT_FALSE(load_given_poses(kRecordedPoses, poses_at({1, 2}), {"a.bag", 3, 9, {}}));
}

}  // namespace
}  // namespace sgs::dataset
