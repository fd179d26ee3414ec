// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/crowd.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "sgs/synthetic/moving_masks.h"
#include "sgs/synthetic/ray_caster.h"
#include "sgs/synthetic/schedule.h"
#include "sgs/synthetic/test_frames.h"

namespace sgs::synthetic {
namespace {

SynthOptions small(const std::string& spec, int frames) {
  SynthOptions options = *parse_synth_spec("synth:" + spec);
  options.frames = frames;
  options.threads = 2;
  options.camera = {160, 120, 133.85, 134.8, 79.6, 61.5};
  return options;
}

// The people of a scene and the camera that sees them.
struct Staged {
  explicit Staged(const std::string& spec)
      : options(small(spec, 0)),
        scene(*make_scene(options)),
        motion(*whole_motion_of(options)),
        crowd(options, *scene, motion, pool) {}
  SE3 camera_at(double time_s) const { return *motion.at(time_s, 1); }

  SynthOptions options;
  ThreadPool pool{2};
  std::shared_ptr<const Scene> scene;
  Trajectory motion;
  Crowd crowd;
};

// Nobody within a pixel: silhouettes are softened.
bool is_still(const GrayImage& mask, int x, int y) {
  for (int v = y - 1; v <= y + 1; ++v)
    for (int u = x - 1; u <= x + 1; ++u)
      if (mask(u, v) != 0) return false;
  return true;
}

TEST(CrowdSpec, ReadsOptionsAndWritesThemBack) {
  const auto options = parse_synth_spec("synth:room+still+plain+walkers40+box:real");
  ASSERT_TRUE(options);
  EXPECT_EQ(options->scene, "room");
  EXPECT_EQ(options->level, "real");
  EXPECT_EQ(options->crowd.view_percent, 40);
  EXPECT_TRUE(options->crowd.box);
  EXPECT_TRUE(options->crowd.plain);
  EXPECT_FALSE(options->crowd.follower);
  EXPECT_EQ(options->motion, CameraMotion::kStill);
  EXPECT_EQ(scene_text(*options), "room+walkers40+box+plain+still");
  EXPECT_TRUE(parse_synth_spec("synth:room+turning")->crowd.empty());
}

TEST(CrowdSpec, UnknownOptionsListTheNearestFirst) {
  const auto options = parse_synth_spec("synth:room+walker40");
  ASSERT_FALSE(options);
  EXPECT_THAT(options.error().remedy, testing::HasSubstr("first: walkers"));
  EXPECT_FALSE(parse_synth_spec("synth:room+"));
}

TEST(Crowd, LeavesTheRestOfThePictureAsItIs) {
  const SynthOptions with = small("room+walkers40+follower:clean", 3);
  const auto crowded = frames_of(with), empty = frames_of(small("room:clean", 3));
  auto masks = make_moving_masks(with);
  ASSERT_TRUE(masks && *masks);
  ASSERT_EQ(crowded.size(), empty.size());
  for (std::size_t i = 0; i < crowded.size(); ++i) {
    const GrayImage mask = (*masks)->mask(static_cast<std::int64_t>(i));
    int covered = 0;
    for (int y = 1; y < 119; ++y)
      for (int x = 1; x < 159; ++x) {
        if (mask(x, y) != 0) {
          ++covered;
          EXPECT_LE(crowded[i].depth(x, y), empty[i].depth(x, y));
        } else if (is_still(mask, x, y)) {
          ASSERT_EQ(crowded[i].color(x, y), empty[i].color(x, y));
          ASSERT_EQ(crowded[i].depth(x, y), empty[i].depth(x, y));
        }
      }
    EXPECT_GT(covered, 500);
    EXPECT_LT((crowded[i].truth_T_world_camera->t - empty[i].truth_T_world_camera->t).norm(),
              1e-12);
  }
}

TEST(Crowd, WalkersTakeTheShareOfTheViewThatIsAskedFor) {
  for (const int percent : {20, 40, 60}) {
    SynthOptions options = small("room+walkers" + std::to_string(percent) + ":clean", 0);
    options.rate_hz = 2;
    auto masks = make_moving_masks(options);
    ASSERT_TRUE(masks && *masks);
    double share = 0;
    constexpr int kFrames = 38;
    for (int i = 0; i < kFrames; ++i) {
      const GrayImage mask = (*masks)->mask(i);
      const auto still = std::count(mask.data(), mask.data() + mask.size(), std::uint8_t{0});
      share += 1 - static_cast<double>(still) / static_cast<double>(mask.size());
    }
    EXPECT_NEAR(100 * share / kFrames, percent, 6);
  }
}

TEST(Crowd, SurfacesOfBodiesAreHitWhereTheyAre) {
  Staged staged("room+walkers60+box:clean");
  const PinholeCamera& camera = staged.options.camera;
  int on_capsules = 0;
  for (const double t : {2.0, 7.0, 12.0}) {
    const auto movers = staged.crowd.at(t);
    const SE3 T = staged.camera_at(t);
    RayRequest request{camera, {T}};
    request.movers = movers;
    const RayImage seen = cast_rays(*staged.scene, request, staged.pool);
    const std::size_t still = staged.scene->primitives.size();
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 160; ++x) {
        const auto i = static_cast<std::size_t>(160 * y + x);
        if (seen.surface[i] == 0xffff || seen.surface[i] < still) continue;
        const Primitive& part = movers[seen.surface[i] - still];
        const Eigen::Vector3f p =
            (T * camera.back_project(x, y, double{seen.depth[i]})).cast<float>();
        ASSERT_LT(part.distance(p), 5e-4f);
        ASSERT_GE(seen.cosine[i], 0);
        on_capsules += part.kind == Primitive::Kind::kCapsule ? 1 : 0;
      }
  }
  EXPECT_GT(on_capsules, 5000);
}

TEST(Crowd, PeopleWalkStopAndComeBack) {
  const Staged staged("room+walkers40+still:clean");
  int resting = 0, walking = 0;
  for (double t = 2; t < 20; t += 0.1) {
    const std::vector<float> steps = staged.crowd.steps(t);
    ASSERT_EQ(steps.size(), 2 * kBodyParts);
    EXPECT_LT(*std::max_element(steps.begin(), steps.end()), 0.2f);
    (steps[0] < 0.003f ? resting : walking) += 1;  // the first one's trunk
  }
  EXPECT_GT(resting, 10);
  EXPECT_GT(walking, 80);
}

TEST(Crowd, WhoStandsStandsWhateverTheCameraDoes) {
  for (const char* spec : {"room_desk+walkers40:clean", "room+walkers40+turning:clean"}) {
    const Staged staged(spec);
    int standing = 0;
    double nearest_m = 10;
    for (double t = 1; t < 15; t += 0.1) {
      const std::vector<float> steps = staged.crowd.steps(t);
      for (const std::size_t trunk : {std::size_t{0}, std::size_t{kBodyParts}})
        standing += steps[trunk] < 1e-5f ? 1 : 0;
      const Eigen::Vector3f eye = staged.camera_at(t).t.cast<float>();
      for (const Primitive& part : staged.crowd.at(t)) {
        nearest_m = std::min(nearest_m, double{part.distance(eye)});
      }
    }
    EXPECT_GT(standing, 10) << spec;
    EXPECT_GT(nearest_m, 0.15) << spec;
  }
}

TEST(Crowd, AStandingCameraStandsAndATurningOneTurns) {
  const auto still = frames_of(small("room+still:clean", 4));
  EXPECT_EQ((still[3].truth_T_world_camera->t - still[0].truth_T_world_camera->t).norm(), 0);
  SynthOptions options = small("room+turning:clean", 0);
  options.rate_hz = 2;
  double farthest = 0;
  const auto turning = frames_of(options);
  for (const RgbdFrame& f : turning) {
    const SE3 T = turning[0].truth_T_world_camera->inverse() * *f.truth_T_world_camera;
    EXPECT_LT(T.t.norm(), 1e-9);
    farthest = std::max(farthest, T.angle());
  }
  EXPECT_GT(farthest, 0.5);
}

TEST(Crowd, SameBitsForAnyNumberOfThreadsBehindALensToo) {
  SynthOptions options = small("room_desk+walkers20:real", 3);
  options.as_recorded = true;
  const auto two = frames_of(options);
  auto masks_of_two = make_moving_masks(options);
  options.threads = 1;
  const auto one = frames_of(options);
  auto masks = make_moving_masks(options);
  ASSERT_TRUE(masks && masks_of_two);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(std::equal(one[i].color.data(), one[i].color.data() + one[i].color.size(),
                           two[i].color.data()));
    const auto index = static_cast<std::int64_t>(i);
    const GrayImage a = (*masks)->mask(index), b = (*masks_of_two)->mask(index);
    EXPECT_TRUE(std::equal(a.data(), a.data() + a.size(), b.data()));
    EXPECT_TRUE(std::any_of(a.data(), a.data() + a.size(), [](std::uint8_t v) { return v > 0; }));
  }
}

TEST(Crowd, NobodyHasNoMasks) {
  const auto masks = make_moving_masks(small("room+still:kinect", 1));
  ASSERT_TRUE(masks);
  EXPECT_EQ(*masks, nullptr);
}

}  // namespace
}  // namespace sgs::synthetic
