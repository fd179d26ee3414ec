// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/novel_views.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sgs/synthetic/source.h"

namespace sgs::run {
namespace {

/// A run of a few frames whose poses are right, and whose map is made of the pixels of one view.
run::Run run_with_a_map() {
  run::Run run;
  run.input.input = "synth:room_desk:clean";
  run.input.frames = "0:4";
  auto input = open_input(run.input, 1);
  EXPECT_TRUE(input);
  run.camera = input->source->camera();
  run.truth = input->source->ground_truth();
  RgbdFrame frame;
  Error error;
  while (input->source->next(frame, error) == dataset::FrameRead::kOk) {
    slam::FrameRecord record;
    record.index = frame.index;
    record.timestamp_s = frame.timestamp_s;
    record.status = tracker::TrackingStatus::kOk;
    run.frames.push_back(record);
    const SE3& T = *frame.truth_T_world_camera;
    run.trajectory.push_back({frame.timestamp_s, T});
    if (frame.index > 0) continue;
    constexpr int kStep = 4;
    for (int v = 0; v < frame.depth.height(); v += kStep) {
      for (int u = 0; u < frame.depth.width(); u += kStep) {
        const float z = frame.depth(u, v);
        if (!(z > 0)) continue;
        const Eigen::Vector3d p = T * run.camera.back_project(u, v, z);
        map::Gaussian g{};
        for (int k = 0; k < 3; ++k) g.mean[k] = static_cast<float>(p[k]);
        for (float& s : g.log_scale) s = std::log(0.6f * kStep * z / 535);
        g.rotation[0] = 1;
        g.opacity_logit = 2;
        const Rgb8& c = frame.color(u, v);
        g.rgb[0] = static_cast<float>(c.r) / 255;
        g.rgb[1] = static_cast<float>(c.g) / 255;
        g.rgb[2] = static_cast<float>(c.b) / 255;
        run.gaussians.push_back(g);
      }
    }
  }
  return run;
}

TEST(NovelViews, ABetterMapScoresHigher) {
  run::Run run = run_with_a_map();
  const auto good = score_novel_views(run, 4, nullptr, 1);
  ASSERT_TRUE(good) << good.error().text();
  ASSERT_TRUE(good->psnr_db && good->ssim && good->depth_l1_m);
  EXPECT_EQ(good->views, 4);
  EXPECT_FALSE(good->lpips);
  EXPECT_LT(*good->depth_l1_m, 0.1);
  for (std::size_t i = 0; i < run.gaussians.size(); ++i) {
    run.gaussians[i].rgb[0] += i % 2 == 0 ? 0.2f : -0.2f;
  }
  const auto bad = score_novel_views(run, 4, nullptr, 1);
  ASSERT_TRUE(bad);
  EXPECT_LT(*bad->psnr_db, *good->psnr_db);
}

TEST(NovelViews, BrightnessIsNotJudged) {
  run::Run run = run_with_a_map();
  const auto before = score_novel_views(run, 4, nullptr, 1);
  for (map::Gaussian& g : run.gaussians) {
    for (float& c : g.rgb) c *= 0.8f;
  }
  const auto after = score_novel_views(run, 4, nullptr, 1);
  ASSERT_TRUE(before && after);
  EXPECT_NEAR(*after->psnr_db, *before->psnr_db, 0.01);
}

TEST(NovelViews, ARecordingHasNoOtherViews) {
  run::Run run;
  run.input.input = "folder";
  EXPECT_FALSE(score_novel_views(run, 4, nullptr, 1));
}

}  // namespace
}  // namespace sgs::run
