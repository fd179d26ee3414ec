// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/run_evaluator.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgs::eval {
namespace {

/// Paints the whole view grey at 2 m, whatever the map: scores follow from the frames by hand.
class GreyRasterizer : public render::Rasterizer {
 public:
  std::string name() const override { return "grey"; }
  void render(std::span<const map::Gaussian>, const PinholeCamera& camera, const SE3&,
              render::Rendering& out) override {
    ++calls;
    out.color = Image<render::Rgbf>(camera.width, camera.height, {0.2f, 0.2f, 0.2f});
    out.depth_sum = Image<float>(camera.width, camera.height, 2.0f);
    out.alpha = Image<float>(camera.width, camera.height, 1.0f);
  }
  std::shared_ptr<const render::TrainingView> prepare(const render::TrainingImage&) const override {
    return nullptr;
  }
  void evaluate(std::span<const map::Gaussian>, const render::TrainingView&, const SE3&,
                const render::LossConfig&, render::Gradients&,
                const render::EvaluateOptions&) override {}
  int calls = 0;
};

constexpr int kWidth = 24, kHeight = 16;

/// `count` frames of one grey (102: 0.4; held-out frames 51: 0.2, as rendered), lower half without
/// depth, the upper at 2.1 m.
std::function<bool(RgbdFrame&)> frames(int count) {
  return [count, next = 0](RgbdFrame& frame) mutable {
    if (next == count) return false;
    frame.index = next++;
    frame.camera = {kWidth, kHeight, 20, 20, 12, 8};
    const std::uint8_t grey = is_heldout(frame.index) ? 51 : 102;
    frame.color = ColorImage(kWidth, kHeight, {grey, grey, grey});
    frame.depth = DepthImage(kWidth, kHeight, 2.1f);
    for (int y = kHeight / 2; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) frame.depth(x, y) = 0;
    }
    return true;
  };
}

RunInput input(int count, GreyRasterizer& rasterizer) {
  RunInput in;
  in.next_frame = frames(count);
  in.pose_of = [](const RgbdFrame&) { return SE3(); };
  in.frames_expected = count;
  in.rasterizer = &rasterizer;
  return in;
}

TEST(RunEvaluator, RulesSideBySide) {
  GreyRasterizer rasterizer;
  RunEvaluatorConfig config;
  config.pictures = 3;
  const auto r = evaluate_run(input(16, rasterizer), config);
  const double off = -10 * std::log10(0.04), off_half = off + 10 * std::log10(2);
  EXPECT_EQ(r.frames_seen, 16);
  EXPECT_EQ(r.full.frames, 16);
  EXPECT_EQ(r.heldout.frames, 2);  // 4 and 12
  EXPECT_NEAR(*r.full.psnr_db, (14 * off + 2 * kMaxPsnr_db) / 16, 1e-4);
  EXPECT_NEAR(*r.gsicp.psnr_db, (14 * off_half + 2 * kMaxPsnr_db) / 16, 1e-4);
  EXPECT_NEAR(*r.heldout.psnr_db, kMaxPsnr_db, 1e-9);
  EXPECT_NEAR(*r.heldout.ssim, 1, 1e-6);
  EXPECT_LT(*r.full.ssim, 1);
  EXPECT_NEAR(*r.depth_l1_m, 0.1, 1e-6);
  EXPECT_NEAR(*r.depth_coverage, 1, 1e-9);
  EXPECT_FALSE(r.full.lpips);
  ASSERT_EQ(r.pictures.size(), 3u);
  EXPECT_EQ(r.pictures[1].index, 8);
  EXPECT_EQ(r.pictures[0].truth.width(), kWidth);
  EXPECT_FALSE(r.cancelled);
  EXPECT_FALSE(r.protocol.empty());
}

TEST(RunEvaluator, ExposureThatIsKnownBrightensHeldOutFramesInAScoreOfItsOwn) {
  GreyRasterizer rasterizer;
  EXPECT_FALSE(evaluate_run(input(16, rasterizer), {}).scores.psnr_db_exposed);
  RunInput in = input(16, rasterizer);
  in.gain_of = [](const RgbdFrame& f) {
    return f.index == 4 ? std::optional(std::array<float, 3>{1.5f, 1.5f, 1.5f}) : std::nullopt;
  };
  const auto r = evaluate_run(in, {});
  EXPECT_NEAR(*r.scores.psnr_db_exposed, -20 * std::log10(0.1), 1e-4);
  EXPECT_NEAR(*r.scores.psnr_db_heldout, kMaxPsnr_db, 1e-9);
}

TEST(RunEvaluator, StrideKeepsHeldOutFrames) {
  GreyRasterizer rasterizer;
  RunEvaluatorConfig config;
  config.stride = 5;
  const auto r = evaluate_run(input(20, rasterizer), config);
  EXPECT_EQ(r.full.frames, 4);
  EXPECT_EQ(r.heldout.frames, 2);
  EXPECT_EQ(rasterizer.calls, 6);  // 0 4 5 10 12 15
}

TEST(RunEvaluator, FramesWithoutPoseAndCancellation) {
  GreyRasterizer rasterizer;
  RunInput in = input(40, rasterizer);
  in.pose_of = [](const RgbdFrame& f) {
    return f.index % 2 == 0 ? std::optional(SE3()) : std::nullopt;
  };
  auto r = evaluate_run(in, {});
  EXPECT_EQ(r.frames_without_pose, 20);
  EXPECT_EQ(r.full.frames, 20);
  in = input(40, rasterizer);
  int asked = 0;
  in.cancelled = [&] { return ++asked > 2; };
  r = evaluate_run(in, {});
  EXPECT_TRUE(r.cancelled);
  EXPECT_EQ(r.full.frames, 8);
  EXPECT_TRUE(r.full.psnr_db);
}

TEST(RunEvaluator, NothingMeasuredIsEmpty) {
  GreyRasterizer rasterizer;
  const auto r = evaluate_run(input(0, rasterizer), {});
  EXPECT_FALSE(r.full.psnr_db);
  EXPECT_FALSE(r.depth_l1_m);
  EXPECT_TRUE(r.pictures.empty());
}

TEST(RunEvaluator, ThreadsDoNotChangeABit) {
  GreyRasterizer rasterizer;
  ThreadPool pool(3);
  RunInput in = input(30, rasterizer);
  in.pool = &pool;
  const auto a = evaluate_run(in, {}), b = evaluate_run(input(30, rasterizer), {});
  EXPECT_EQ(*a.full.psnr_db, *b.full.psnr_db);
  EXPECT_EQ(*a.full.ssim, *b.full.ssim);
  EXPECT_EQ(*a.gsicp.ssim, *b.gsicp.ssim);
  EXPECT_EQ(a.pictures.size(), b.pictures.size());
}

// A black border beside a picture that is rendered as it was seen costs nothing.
TEST(RunEvaluator, PixelsThatWereNotSeenAreNotScored) {
  GreyRasterizer rasterizer;
  const auto evaluated = [&](bool with_mask) {
    RunInput in = input(6, rasterizer);
    in.next_frame = [with_mask, next = frames(6)](RgbdFrame& frame) mutable {
      if (!next(frame)) return false;
      auto seen = std::make_shared<PixelMask>(kWidth, kHeight, std::uint8_t{1});
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < 6; ++x) {
          frame.color(x, y) = {0, 0, 0};
          (*seen)(x, y) = 0;
        }
      }
      if (with_mask) frame.seen = seen;
      return true;
    };
    RunEvaluatorConfig config;
    config.pictures = 2;
    return evaluate_run(in, config);
  };
  const RunEvaluation masked = evaluated(true), unmasked = evaluated(false);
  // Frames 0 to 3 and 5 are 0.4 where 0.2 is rendered; frame 4 is held out, and as rendered.
  EXPECT_NEAR(*masked.train.psnr_db, -20 * std::log10(0.2), 1e-3);
  EXPECT_EQ(*masked.heldout.psnr_db, kMaxPsnr_db);
  EXPECT_LT(*unmasked.heldout.psnr_db, 30);
}

}  // namespace
}  // namespace sgs::eval
