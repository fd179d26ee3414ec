// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/color_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sgs/synthetic/auto_exposure.h"

namespace sgs::synthetic {
namespace {

const PinholeCamera kSmallCamera{160, 120, 133.85, 134.8, 79.6, 61.5};

ResponseModel plain_response() {
  ResponseModel m;
  m.camera = true;
  m.gamma = 0.5f;  // light is the square of the colour
  m.full_well = 1e12f;
  return m;
}

ColorCamera camera_of(const ResponseModel& model, const Distortion& lens = {}) {
  return ColorCamera(model, std::make_shared<LensRays>(LensCamera{kSmallCamera, lens}), 3);
}

// A wall two metres ahead, of one colour left of `border` and another right of it.
RayImage two_tone_wall(float left, float right, int border = 80) {
  const std::size_t n = static_cast<std::size_t>(kSmallCamera.width * kSmallCamera.height);
  RayImage view{kSmallCamera.width,
                kSmallCamera.height,
                std::vector<float>(n, 2.f),
                std::vector<float>(n, 1.f),
                std::vector<std::uint16_t>(n, 0),
                {},
                {}};
  for (std::size_t i = 0; i < n; ++i) {
    const float c = static_cast<int>(i) % kSmallCamera.width < border ? left : right;
    view.color.emplace_back(c, c, c, 0.f);
  }
  return view;
}

struct Spread {
  double mean = 0, sigma = 0;
};

Spread green(const ColorImage& image, int from, int to) {
  double sum = 0, sum2 = 0, n = 0;
  for (int y = 10; y < image.height() - 10; ++y)
    for (int x = from; x < to; ++x) {
      const double g = image(x, y).g;
      sum += g, sum2 += g * g, n += 1;
    }
  return {sum / n, std::sqrt(std::max(0.0, sum2 / n - sum / n * sum / n))};
}

// Columns over which the picture goes from dark to bright.
int width_of_edge(const ColorImage& image) {
  int columns = 0;
  for (int x = 0; x < image.width(); ++x) {
    const int g = image(x, 60).g;
    columns += g > 60 && g < 195 ? 1 : 0;
  }
  return columns;
}

TEST(ColorCamera, RootGivesTheColourBack) {
  ThreadPool pool(1);
  const ColorImage image =
      camera_of(plain_response()).picture(two_tone_wall(0.2f, 0.8f), SE3(), {}, 0, pool);
  EXPECT_NEAR(green(image, 10, 70).mean, 0.2 * 255, 1);
  EXPECT_NEAR(green(image, 90, 150).mean, 0.8 * 255, 1);
}

TEST(ColorCamera, CurveRisesToWhiteAndIsFlatThere) {
  ResponseModel m = plain_response();
  m.contrast = 1;
  const ColorCamera camera = camera_of(m);
  for (int k = 1; k <= 100; ++k)
    EXPECT_GE(camera.grey(0.01f * static_cast<float>(k)),
              camera.grey(0.01f * static_cast<float>(k - 1)));
  EXPECT_EQ(camera.grey(0), 0);
  EXPECT_EQ(camera.grey(1), 1);
  EXPECT_EQ(camera.grey(7), 1);
  EXPECT_GT(camera.grey(0.9f), 0.98f);
}

TEST(ColorCamera, NoiseGrowsWithLightAndEndsAtWhite) {
  ResponseModel m = plain_response();
  m.full_well = 1000;
  m.read_noise = 0.002f;
  m.gamma = 1;
  ThreadPool pool(1);
  const ColorCamera camera = camera_of(m);
  const ColorImage image = camera.picture(two_tone_wall(0.3f, 0.7f), SE3(), {}, 0, pool);
  // Half of the greens are means of four.
  const auto raw = [](double light) {
    return 255 * std::sqrt((light / 1000 + 4e-6) * (1 + 0.25) / 2);
  };
  EXPECT_NEAR(green(image, 5, 75).sigma, std::sqrt(std::pow(raw(0.09), 2) + 1. / 12), 0.3);
  EXPECT_NEAR(green(image, 85, 155).sigma, std::sqrt(std::pow(raw(0.49), 2) + 1. / 12), 0.3);
  EXPECT_EQ(green(camera.picture(two_tone_wall(1.5f, 1.5f), SE3(), {}, 0, pool), 5, 155).mean, 255);
}

TEST(ColorCamera, TurningBlursBehindALensToo) {
  ThreadPool pool(1);
  // 20 ms at 2 rad/s: 40 mrad, 5.4 px.
  const SE3 half = SE3::exp((Vector6d() << 0, 0.02, 0, 0, 0, 0).finished());
  for (const Distortion& lens : {Distortion{}, Distortion{0.26, -0.95, 0, 0, 1.16}}) {
    const ColorCamera camera = camera_of(plain_response(), lens);
    EXPECT_LE(width_of_edge(camera.picture(two_tone_wall(0.2f, 0.8f), SE3(), {}, 0, pool)), 2);
    const int blurred = width_of_edge(camera.picture(two_tone_wall(0.2f, 0.8f), half, {}, 0, pool));
    EXPECT_GE(blurred, 4);
    EXPECT_LE(blurred, 7);
  }
}

TEST(ColorCamera, CornersAreDarkerByTheVignette) {
  ResponseModel m = plain_response();
  m.gamma = 1;
  m.vignetting = 0.3f;
  ThreadPool pool(1);
  const ColorImage image = camera_of(m).picture(two_tone_wall(0.8f, 0.8f), SE3(), {}, 0, pool);
  EXPECT_NEAR(image(80, 60).g, 255 * 0.64, 2);
  EXPECT_NEAR(image(0, 0).g, 255 * 0.64 * 0.7, 3);
}

TEST(ColorCamera, SharpeningOvershootsAtEdgesOnly) {
  ResponseModel m = plain_response();
  m.sharpening = 1;
  ThreadPool pool(1);
  const ColorImage image = camera_of(m).picture(two_tone_wall(0.2f, 0.8f), SE3(), {}, 0, pool);
  EXPECT_NEAR(green(image, 10, 70).mean, 0.2 * 255, 1);
  int brightest = 0;
  for (int x = 76; x < 86; ++x) brightest = std::max(brightest, int{image(x, 60).g});
  EXPECT_GT(brightest, 0.8 * 255 + 8);
}

TEST(ColorCamera, CrosstalkTakesColourAway) {
  ResponseModel m = plain_response();
  ThreadPool pool(1);
  RayImage view = two_tone_wall(0.6f, 0.6f);
  for (Eigen::Array4f& c : view.color) c[0] = 0.9f;
  const auto redness = [&] {
    const Rgb8 c = camera_of(m).picture(view, SE3(), {}, 0, pool)(80, 60);
    return c.r - c.g;
  };
  const int without = redness();
  EXPECT_NEAR(without, 0.3 * 255, 2);
  m.crosstalk = 0.5f;
  EXPECT_LT(redness(), 0.6 * without);
  EXPECT_GT(redness(), 0.4 * without);
}

ExposureModel automatic() {
  ExposureModel m;
  m.automatic = true;
  m.usual_s = 0.03;
  m.shortest_s = 0.02;
  m.longest_s = 0.033;
  m.target = 0.5;
  m.hold = 0.08;
  m.largest_step = 0.3;
  m.period = 3;
  m.balance = 0.5;
  m.balance_rate = 0.1;
  return m;
}

TEST(AutoExposure, BrightPartsThatComeIntoViewDarkenTheRest) {
  const ColorCamera camera = camera_of(plain_response());
  AutoExposure control(automatic(), camera);
  control.settle(two_tone_wall(0.3f, 0.3f));
  const auto dark_part = [&] { return camera.grey(control.exposure().gain * 0.3f * 0.3f); };
  const float before = dark_part();
  EXPECT_NEAR(before, 0.5f, 0.02f);
  EXPECT_NEAR(control.exposure().time_s, 0.03, 1e-9);
  float largest = 0;
  for (int k = 0; k < 10; ++k) {
    const float last = dark_part();
    control.advance(two_tone_wall(0.3f, 0.45f, 70));
    largest = std::max(largest, 1 - dark_part() / last);
  }
  const float fall = 1 - dark_part() / before;
  EXPECT_GT(fall, 0.1f);
  EXPECT_LT(fall, 0.3f);
  EXPECT_GT(largest, 0.05f);  // in a step, not by and by
  EXPECT_LT(control.exposure().time_s, 0.03);
  EXPECT_GE(control.exposure().time_s, 0.02);
}

TEST(AutoExposure, HoldsWhileThePictureChangesALittle) {
  const ColorCamera camera = camera_of(plain_response());
  AutoExposure control(automatic(), camera);
  control.settle(two_tone_wall(0.3f, 0.3f));
  const float gain = control.exposure().gain;
  for (int k = 0; k < 20; ++k) control.advance(two_tone_wall(0.3f, 0.315f));
  EXPECT_EQ(control.exposure().gain, gain);
}

TEST(AutoExposure, WhiteBalanceRemovesAPartOfACast) {
  const ColorCamera camera = camera_of(plain_response());
  AutoExposure control(automatic(), camera);
  RayImage view = two_tone_wall(0.4f, 0.4f);
  control.settle(view);
  EXPECT_NEAR(control.exposure().balance[0], 1, 1e-3);
  for (Eigen::Array4f& c : view.color) c[0] *= 1.2f;
  for (int k = 0; k < 100; ++k) control.advance(view);
  EXPECT_LT(control.exposure().balance[0], 0.93f);
  EXPECT_EQ(control.exposure().balance[1], 1);
  EXPECT_NEAR(control.exposure().balance[2], 1, 0.02);
}

}  // namespace
}  // namespace sgs::synthetic
