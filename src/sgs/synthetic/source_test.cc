// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sgs/camera/depth_noise.h"
#include "sgs/synthetic/scene.h"
#include "sgs/synthetic/sensor.h"
#include "sgs/synthetic/test_frames.h"

namespace sgs::synthetic {
namespace {

SynthOptions small(const std::string& scene, const std::string& level) {
  SynthOptions options;
  options.scene = scene;
  options.level = level;
  options.threads = 2;
  options.camera = {160, 120, 133.85, 134.8, 79.6, 61.5};
  return options;
}

bool same_pixels(const RgbdFrame& a, const RgbdFrame& b) {
  return std::equal(a.color.data(), a.color.data() + a.color.size(), b.color.data()) &&
         std::equal(a.depth.data(), a.depth.data() + a.depth.size(), b.depth.data());
}

double valid_fraction(const DepthImage& depth) {
  const auto n =
      std::count_if(depth.data(), depth.data() + depth.size(), [](float z) { return z > 0; });
  return static_cast<double>(n) / static_cast<double>(depth.size());
}

TEST(SynthSpec, ReadsSceneAndLevel) {
  const auto plain = parse_synth_spec("synth:room_desk");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->scene, "room_desk");
  EXPECT_EQ(plain->level, "kinect");
  EXPECT_EQ(parse_synth_spec("synth:corridor:hard")->level, "hard");
}

TEST(SynthSpec, UnknownNamesListTheNearestFirst) {
  const auto scene = parse_synth_spec("synth:room_dask");
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().remedy, testing::HasSubstr("first: room_desk,"));
  const auto level = parse_synth_spec("synth:room:hrad");
  ASSERT_FALSE(level);
  EXPECT_THAT(level.error().remedy, testing::HasSubstr("first: hard,"));
  EXPECT_FALSE(parse_synth_spec("room_desk"));
}

// Fraction of pixels with a step of more than 20 grey levels to the left.
double strong_gradients(const ColorImage& color) {
  int strong = 0;
  for (int y = 0; y < color.height(); ++y)
    for (int x = 1; x < color.width(); ++x)
      strong += std::abs(luma(color(x, y)) - luma(color(x - 1, y))) > 20 ? 1 : 0;
  return strong / static_cast<double>((color.width() - 1) * color.height());
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, IsExactSmoothAndTexturedAsPromised) {
  const SynthOptions options = small(GetParam(), "clean");
  const auto scene = make_scene(options);
  const auto motion = handheld_trajectory(options);
  ASSERT_TRUE(scene && motion);
  ThreadPool pool(2);
  const auto& poses = motion->poses();
  for (const double part : {0.1, 0.5, 0.85}) {
    const SE3& T =
        poses[static_cast<std::size_t>(part * static_cast<double>(poses.size()))].T_world_camera;
    const ExactView view = render_exact(**scene, options.camera, T, pool);
    EXPECT_GT(valid_fraction(view.depth), 0.5);
    for (int y = 3; y < 120; y += 7)
      for (int x = 2; x < 160; x += 7) {
        if (view.depth(x, y) <= 0) continue;
        const Eigen::Vector3d p = options.camera.back_project(x, y, double{view.depth(x, y)});
        float nearest = 1;
        for (const Primitive& s : (*scene)->primitives)
          nearest = std::min(nearest, s.distance((T * p).cast<float>()));
        ASSERT_LT(nearest, 1e-4f);
        ASSERT_NEAR(view.normals(x, y).norm(), 1, 1e-4);
        ASSERT_LE(view.normals(x, y).dot(p.cast<float>()), 1e-4f);
      }
  }
  for (std::size_t i = 20; i < poses.size(); ++i) {
    const SE3 step = poses[i - 20].T_world_camera.inverse() * poses[i].T_world_camera;  // 0.1 s
    ASSERT_LT(step.t.norm(), 0.08) << "faster than 0.8 m/s at " << poses[i].timestamp_s;
    ASSERT_LT(step.angle(), 0.105) << "faster than 60 deg/s at " << poses[i].timestamp_s;
  }
}

TEST_P(EveryScene, SensorSeesEnough) {
  SynthOptions options = small(GetParam(), "kinect");
  options.rate_hz = 1;
  options.frames = 12;
  const auto info = std::find_if(scene_names().begin(), scene_names().end(),
                                 [&](const SceneInfo& i) { return i.name == GetParam(); });
  double gradient = 0;
  const std::vector<RgbdFrame> frames = frames_of(options);
  ASSERT_FALSE(frames.empty());
  for (const RgbdFrame& f : frames) {
    EXPECT_GT(valid_fraction(f.depth), 0.5) << f.index;
    gradient += strong_gradients(f.color) / static_cast<double>(frames.size());
  }
  if (GetParam() == "dual") return;  // half plain, has its own test
  if (info->textured)
    EXPECT_GT(gradient, 0.05);
  else
    EXPECT_LT(gradient, 0.02);
}

TEST(Source, DualIsPlainForThreeSecondsInTheMiddle) {
  SynthOptions options = small("dual", "kinect");
  options.rate_hz = 4;
  const auto frames = frames_of(options);
  ASSERT_EQ(frames.size(), 80u);
  for (const RgbdFrame& f : frames) {
    const double from_middle = std::abs(f.timestamp_s - 1 - 10);
    if (from_middle < 1.5) {
      EXPECT_LT(strong_gradients(f.color), 0.002) << f.timestamp_s;
    }
    if (from_middle > 9) {
      EXPECT_GT(strong_gradients(f.color), 0.03) << f.timestamp_s;
    }
  }
}

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_names()) names.push_back(info.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(all_names()),
                         [](const auto& test) { return test.param; });

TEST(Source, SameBitsForAnyNumberOfThreadsAndOthersForOtherSeeds) {
  SynthOptions options = small("room_desk", "hard");
  options.frames = 4;
  const auto two = frames_of(options);
  options.threads = 1;
  const auto one = frames_of(options);
  options.seed = 2;
  const auto other = frames_of(options);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(same_pixels(one[i], two[i]));
  EXPECT_FALSE(same_pixels(one[0], other[0]));
}

TEST(Source, LengthLimitDoesNotChangeTheFrames) {
  SynthOptions options = small("structure_texture_near", "kinect");
  options.frames = 2;
  const auto two = frames_of(options);
  options.frames = 5;
  const auto five = frames_of(options);
  EXPECT_TRUE(same_pixels(two[1], five[1]));
}

TEST(Source, DepthIsWhatSixteenBitsHold) {
  SynthOptions options = small("room", "clean");
  options.frames = 1;
  const DepthImage depth = frames_of(options)[0].depth;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double raw = std::round(double{depth.data()[i]} * 5000);
    ASSERT_EQ(depth.data()[i], static_cast<float>(raw / 5000));
  }
}

TEST(Source, TwoViewsOfAPointAgreeInColour) {
  const SynthOptions options = small("structure_texture_near", "clean");
  const auto scene = make_scene(options);
  const auto motion = handheld_trajectory(options);
  ThreadPool pool(2);
  const SE3 Ta = *motion->at(2.0, 1), Tb = *motion->at(2.1, 1);
  const ExactView a = render_exact(**scene, options.camera, Ta, pool);
  const ExactView b = render_exact(**scene, options.camera, Tb, pool);
  std::vector<double> matched, unmatched;
  for (int y = 2; y < 118; ++y)
    for (int x = 2; x < 158; ++x) {
      const Eigen::Vector3d p =
          Tb.inverse() * (Ta * options.camera.back_project(x, y, double{a.depth(x, y)}));
      const Eigen::Vector2d uv = options.camera.project(p);
      const int u = static_cast<int>(std::floor(uv.x())), v = static_cast<int>(std::floor(uv.y()));
      if (u < 1 || v < 1 || u > 157 || v > 117) continue;
      if (std::abs(double{b.depth(u, v)} - p.z()) > 0.03) continue;
      const double fx = uv.x() - u, fy = uv.y() - v;
      const double grey =
          (1 - fy) * ((1 - fx) * luma(b.color(u, v)) + fx * luma(b.color(u + 1, v))) +
          fy * ((1 - fx) * luma(b.color(u, v + 1)) + fx * luma(b.color(u + 1, v + 1)));
      matched.push_back(std::abs(grey - luma(a.color(x, y))));
      unmatched.push_back(std::abs(double{luma(b.color(x, y))} - luma(a.color(x, y))));
    }
  ASSERT_GT(matched.size(), 5000u);
  const auto mean = [](const std::vector<double>& v) {
    double sum = 0;
    for (double x : v) sum += x;
    return sum / static_cast<double>(v.size());
  };
  EXPECT_LT(mean(matched), 8);
  EXPECT_LT(mean(matched), 0.6 * mean(unmatched));
}

// A wall seen head on: what the sensor adds can be measured against known numbers.
RayImage flat_wall(float depth, const PinholeCamera& camera) {
  const std::size_t n = static_cast<std::size_t>(camera.width * camera.height);
  return {camera.width,
          camera.height,
          std::vector<float>(n, depth),
          std::vector<float>(n, 1.f),
          std::vector<std::uint16_t>(n, 0),
          std::vector<Eigen::Array4f>(n, Eigen::Array4f(0.5f, 0.5f, 0.5f, 0)),
          {}};
}

TEST(Sensor, KinectNoiseHasTheModelsSpreadAndSteps) {
  const PinholeCamera camera = small("room", "kinect").camera;
  const Sensor sensor(SensorModel::of_level("kinect", 3), camera, 3);
  ThreadPool pool(1);
  for (const float z : {1.f, 2.f, 3.5f}) {
    const DepthImage depth = sensor.depth(flat_wall(z, camera), 7, pool);
    double sum = 0, sum2 = 0, n = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const double d = double{depth.data()[i]};
      if (d <= 0) continue;
      const double eighths = 8 * 43.5 / d;
      ASSERT_NEAR(eighths, std::round(eighths), 8 * 43.5 / (d * d) * 1.1e-4);
      sum += d - double{z}, sum2 += (d - double{z}) * (d - double{z}), n += 1;
    }
    ASSERT_GT(n, 0.98 * static_cast<double>(depth.size()));
    const double sigma = double{depth_sigma_m(z)}, step = double{z} * double{z} / (8 * 43.5);
    EXPECT_NEAR(std::sqrt(sum2 / n), std::sqrt(sigma * sigma + step * step / 12), 0.35 * sigma);
    EXPECT_NEAR(sum / n, 0, 0.5 * step);
  }
  EXPECT_EQ(valid_fraction(sensor.depth(flat_wall(0.4f, camera), 0, pool)), 0);
  EXPECT_EQ(valid_fraction(sensor.depth(flat_wall(5.6f, camera), 0, pool)), 0);
}

TEST(Sensor, ColourNoiseHasTwoAndAHalfGreyLevels) {
  const PinholeCamera camera = small("room", "kinect").camera;
  const Sensor sensor(SensorModel::of_level("kinect", 3), camera, 3);
  ThreadPool pool(1);
  const ColorImage image = sensor.color(flat_wall(2, camera), SE3(), 1, 0, pool);
  double sum2 = 0;
  for (std::size_t i = 0; i < image.size(); ++i) sum2 += std::pow(image.data()[i].g - 127.5, 2);
  EXPECT_NEAR(std::sqrt(sum2 / static_cast<double>(image.size())), 2.52, 0.1);
}

TEST(Sensor, HardLosesTwoPercentAndDriftsByTwenty) {
  const Sensor sensor(SensorModel::of_level("hard", 3), small("room", "hard").camera, 3);
  int lost = 0;
  float lo = 1, hi = 1;
  for (int i = 0; i < 20000; ++i) {
    lost += sensor.frame_lost(i) ? 1 : 0;
    lo = std::min(lo, sensor.gain(i / 30.0));
    hi = std::max(hi, sensor.gain(i / 30.0));
  }
  EXPECT_NEAR(lost, 400, 80);
  EXPECT_NEAR(lo, 0.8, 0.06);
  EXPECT_NEAR(hi, 1.2, 0.06);
  EXPECT_GE(lo, 0.8f);
  EXPECT_LE(hi, 1.2f);
}

TEST(Sensor, HardDepthPatternStaysFromFrameToFrame) {
  const PinholeCamera camera = small("room", "hard").camera;
  const Sensor sensor(SensorModel::of_level("hard", 3), camera, 3);
  ThreadPool pool(1);
  const auto mean_of = [&](int first) {
    std::vector<double> mean(static_cast<std::size_t>(camera.width * camera.height));
    for (int f = first; f < first + 30; ++f) {
      const DepthImage d = sensor.depth(flat_wall(2, camera), f, pool);
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += (double{d.data()[i]} - 2) / 30;
    }
    return mean;
  };
  const auto a = mean_of(0), b = mean_of(100);
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    ab += a[i] * b[i], aa += a[i] * a[i], bb += b[i] * b[i];
  EXPECT_GT(ab / std::sqrt(aa * bb), 0.9);
  EXPECT_GT(std::sqrt(aa / static_cast<double>(a.size())), 0.005);
}

TEST(Sensor, VariedErrsInAnotherWayWithEachSeed) {
  const PinholeCamera camera = small("room", "varied").camera;
  std::vector<double> offsets;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const SensorModel model = SensorModel::of_level("varied", seed);
    EXPECT_EQ(model.factor, SensorModel::of_level("varied", seed).factor);
    const Sensor sensor(model, camera, seed);
    // Inverse depth that is missing: an offset, and what is relative divided by the depth.
    const auto mean_at = [&](float depth_m) {
      const std::vector<float> wall(static_cast<std::size_t>(camera.width), depth_m);
      double sum = 0;
      for (int y = 0; y < camera.height; ++y) {
        for (const float offset : sensor.inverse_depth_offsets(y, wall.data()))
          sum += double{offset};
      }
      return sum / (camera.width * camera.height);
    };
    // The factor over the image has no mean: near, all that is left is the offset of disparity.
    EXPECT_NEAR(mean_at(0.6f), double{model.disparity_per_m}, 0.0012);
    EXPECT_NEAR(mean_at(3), double{model.disparity_per_m + 3 * model.growth_per_m2}, 0.0012);
    EXPECT_GE(std::abs(model.factor), 0.003f);
    offsets.push_back(double{model.disparity_per_m});
  }
  EXPECT_LT(*std::min_element(offsets.begin(), offsets.end()), -0.001);
  EXPECT_GT(*std::max_element(offsets.begin(), offsets.end()), 0.001);
}

TEST(RealMotion, KeepsTheSceneInView) {
  const char* shared = std::getenv("SGS_SHARED_DIR");
  const std::filesystem::path root =
      shared ? std::filesystem::path(shared) : std::filesystem::path(SGS_SOURCE_DIR) / "../shared";
  const std::pair<const char*, const char*> runs[] = {
      {"freiburg3_nostructure_texture_far", "nostructure_texture_far"},
      {"freiburg3_nostructure_texture_near_withloop", "nostructure_texture_near"},
      {"freiburg3_structure_notexture_near", "structure_notexture_near"},
      {"freiburg3_structure_notexture_far", "structure_notexture_far"},
      {"freiburg1_desk", "room_desk"},
      {"freiburg1_xyz", "room_desk"},
      {"freiburg2_xyz", "room_desk"},
      {"freiburg3_long_office_household", "office"}};
  for (const auto& [sequence, scene] : runs) {
    const auto path =
        root / "data/trajectories" / (std::string("rgbd_dataset_") + sequence) / "groundtruth.txt";
    std::ifstream file(path);
    if (!file) GTEST_SKIP() << "no trajectories at " << path;
    std::vector<StampedPose> poses;
    for (std::string line; std::getline(file, line);) {
      std::istringstream in(line);
      double t, x, y, z, qx, qy, qz, qw;
      if (in >> t >> x >> y >> z >> qx >> qy >> qz >> qw)
        poses.push_back({t, SE3(Eigen::Quaterniond(qw, qx, qy, qz), Eigen::Vector3d(x, y, z))});
    }
    SynthOptions options = small(scene, "kinect");
    options.trajectory = Trajectory(poses);
    options.rate_hz = 2;
    const auto frames = frames_of(options);
    ASSERT_GT(frames.size(), 20u);
    const auto good = std::count_if(frames.begin(), frames.end(), [](const RgbdFrame& f) {
      return valid_fraction(f.depth) >= 0.7;
    });
    EXPECT_GE(static_cast<double>(good), 0.95 * static_cast<double>(frames.size())) << sequence;
  }
}

}  // namespace
}  // namespace sgs::synthetic
