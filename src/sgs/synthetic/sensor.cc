// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/sensor.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sgs/camera/depth_noise.h"

namespace sgs::synthetic {

namespace {

constexpr double kUnitsPerMetre = 5000;
constexpr int kStrip = 16;
// Kinect: 580 px focal length, 75 mm between projector and infrared camera.
constexpr float kDisparityPxM = 580 * 0.075f;
constexpr float kBaselineM = 0.075f;

// A 16-bit depth image of 5000 units per metre, written and read back.
float store_depth(float z) {
  const double raw = std::round(double{z} * kUnitsPerMetre);
  return raw > 0 && raw < 65535 ? static_cast<float>(raw / kUnitsPerMetre) : 0.f;
}

Eigen::Array4f bilinear(const RayImage& image, float x, float y) {
  x = std::clamp(x, 0.f, static_cast<float>(image.width) - 1.001f);
  y = std::clamp(y, 0.f, static_cast<float>(image.height) - 1.001f);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const Eigen::Array4f* c = image.color.data() + std::ptrdiff_t{y0} * image.width + x0;
  const Eigen::Array4f top = c[0] + fx * (c[1] - c[0]);
  const Eigen::Array4f bottom = c[image.width] + fx * (c[image.width + 1] - c[image.width]);
  return top + fy * (bottom - top);
}

// Smooth noise over time within about -1 and 1, changing over `period_s`.
float drift(std::uint64_t key, double t_s, double period_s) {
  const double u = t_s / period_s, cell = std::floor(u);
  const float f = static_cast<float>(u - cell), s = f * f * (3 - 2 * f);
  const auto at = [&](double c) {
    return 2 * unit_float(hash64(key, static_cast<std::uint64_t>(c + 1e6))) - 1;
  };
  return (1 - s) * at(cell) + s * at(cell + 1);
}

}  // namespace

Sensor::Sensor(const SensorModel& model, const PinholeCamera& camera, std::uint64_t seed)
    : model_(model), camera_(camera), seed_(hash64(seed, hash_name("sensor"))) {
  if (!model.hard) return;
  const float scale = static_cast<float>(camera.width) / 640;
  pattern_.emplace(camera.width, camera.height, std::max(4.f, 50 * scale), hash64(seed_, 1));
  distortion_.emplace(camera.width, camera.height, std::max(8.f, 320 * scale), hash64(seed_, 2));
  if (model.factor == 0) return;
  factor_.emplace(camera.width, camera.height, std::max(8.f, 240 * scale), hash64(seed_, 10));
  std::vector<float> row(static_cast<std::size_t>(camera.width));
  double sum = 0;
  for (int y = 0; y < camera.height; ++y) {
    factor_->row(y, row.data());
    sum = std::accumulate(row.begin(), row.end(), sum);
  }
  factor_mean_ = static_cast<float>(sum / (double{1} * camera.width * camera.height));
}

// What the sensor makes of the depths of a row before any noise.
struct Sensor::SystematicRow {
  const Sensor& sensor;
  std::vector<float> pattern, bend, factor;  // fields along the row

  float operator()(std::size_t x, float depth_m) const {
    const SensorModel& m = sensor.model_;
    const float r = std::clamp(depth_m / 3, 0.3f, 1.5f);
    const float measured = depth_m * (1 + m.distortion * r * std::clamp(bend[x], -1.f, 1.f)) +
                           m.pattern * depth_m * depth_m * pattern[x];
    if (!sensor.factor_) return measured;
    const float relative =
        m.factor * (factor[x] - sensor.factor_mean_) + m.growth_per_m2 * depth_m * depth_m;
    return measured * (1 + relative) / (1 - m.disparity_per_m * measured);
  }
};

Sensor::SystematicRow Sensor::systematic_row(int y) const {
  const std::vector<float> none(static_cast<std::size_t>(camera_.width), 0.f);
  SystematicRow out{*this, none, none, none};
  if (pattern_) pattern_->row(y, out.pattern.data()), distortion_->row(y, out.bend.data());
  if (factor_) factor_->row(y, out.factor.data());
  return out;
}

Eigen::Vector2d Sensor::registration_shift() const {
  const double angle = 2 * M_PI * double{unit_float(hash64(seed_, 3))};
  return model_.misregistration_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

bool Sensor::frame_lost(std::int64_t frame) const {
  // The first frame is always there: it fixes the origin.
  return frame > 0 &&
         double{unit_float(hash64(hash64(seed_, 4), static_cast<std::uint64_t>(frame)))} <
             model_.lost_frames;
}

float Sensor::gain(double t_s) const {
  if (model_.exposure_drift == 0) return 1;
  // Three quarters drift slowly; one quarter jumps every 3 s, as automatic exposure does.
  const float step =
      2 * unit_float(hash64(hash64(seed_, 6), static_cast<std::uint64_t>(t_s / 3 + 1e6))) - 1;
  return 1 + model_.exposure_drift * (0.75f * drift(hash64(seed_, 5), t_s, 4) + 0.25f * step);
}

std::vector<float> Sensor::inverse_depth_offsets(int y, const float* depth_m) const {
  std::vector<float> out(static_cast<std::size_t>(camera_.width));
  if (!pattern_) return out;
  const SystematicRow systematic = systematic_row(y);
  for (std::size_t x = 0; x < out.size(); ++x) {
    const float z = depth_m[x];
    if (z > 0) out[x] = 1 / z - 1 / systematic(x, z);
  }
  return out;
}

void Sensor::depth_row(const RayImage& exact, int y, std::int64_t frame,
                       const SmoothField* correlated, float* out) const {
  const int w = exact.width;
  const std::size_t n = static_cast<std::size_t>(w);
  const std::ptrdiff_t begin = std::ptrdiff_t{y} * w;
  const float* z = exact.depth.data() + begin;
  const float* up = y > 0 ? z - w : z;
  const float* down = y + 1 < exact.height ? z + w : z;
  std::vector<float> smooth(n, 0.f);
  if (correlated) correlated->row(y, smooth.data());
  const SystematicRow systematic = systematic_row(y);
  const GaussTable& gauss = GaussTable::instance();
  const std::uint64_t key = hash64(hash64(seed_, 7), static_cast<std::uint64_t>(frame));
  const float shadow = static_cast<float>(camera_.fx) * kBaselineM;
  float lit = -1e9f;  // column, seen from the projector, up to which the row is covered
  for (int x = 0; x < w; ++x) {
    const float d = z[x];
    out[x] = 0;
    if (d <= 0) continue;
    const float column = static_cast<float>(x) - shadow / d;
    const bool shaded = column < lit - 1.5f;
    lit = std::max(lit, column);
    const float jump = 0.02f + 0.03f * d;
    const float left = z[x > 0 ? x - 1 : x], right = z[x + 1 < w ? x + 1 : x];
    const bool edge =
        std::abs(left + right - 2 * d) > jump || std::abs(up[x] + down[x] - 2 * d) > jump;
    const std::size_t i = static_cast<std::size_t>(x);
    const std::uint64_t h = hash64(key + static_cast<std::uint64_t>(begin + x));
    const float luck = unit_float(h * 0x9e3779b97f4a7c15ull);
    const float cosine = exact.cosine[static_cast<std::size_t>(begin) + i];
    // Certain below 10 degrees from the surface, gone at 20.
    const float grazing = (0.342f - cosine) / (0.342f - 0.174f);
    if (shaded || (edge && luck < model_.edge_losses) || luck < grazing) continue;
    const float sigma = depth_sigma_m(d);
    float measured = systematic(i, d) + sigma * (gauss(h, 0) + model_.correlated_noise * smooth[i]);
    if (measured <= 0.1f) continue;
    const float disparity = std::round(kDisparityPxM / measured * 8) / 8;
    measured = kDisparityPxM / std::max(disparity, 0.125f);
    if (measured < model_.min_depth_m || measured > model_.max_depth_m) continue;
    out[x] = store_depth(measured);
  }
}

DepthImage Sensor::depth(const RayImage& exact, std::int64_t frame, ThreadPool& pool) const {
  DepthImage image(exact.width, exact.height);
  std::optional<SmoothField> correlated;
  if (model_.correlated_noise > 0)
    correlated.emplace(exact.width, exact.height, 8.f,
                       hash64(hash64(seed_, 8), static_cast<std::uint64_t>(frame)));
  pool.run((exact.height + kStrip - 1) / kStrip, [&](int strip, int) {
    for (int y = strip * kStrip; y < std::min(exact.height, (strip + 1) * kStrip); ++y) {
      if (model_.noise) {
        depth_row(exact, y, frame, correlated ? &*correlated : nullptr, image.row(y));
        continue;
      }
      const float* z = exact.depth.data() + std::ptrdiff_t{y} * exact.width;
      for (int x = 0; x < exact.width; ++x) image(x, y) = store_depth(z[x]);
    }
  });
  return image;
}

ColorImage Sensor::color(const RayImage& exact, const SE3& half_motion, float gain,
                         std::int64_t frame, ThreadPool& pool) const {
  ColorImage image(exact.width, exact.height);
  const Eigen::Matrix3f R = half_motion.R.cast<float>();
  const Eigen::Vector3f t = half_motion.t.cast<float>();
  const float fx = static_cast<float>(camera_.fx), fy = static_cast<float>(camera_.fy);
  const float cx = static_cast<float>(camera_.cx), cy = static_cast<float>(camera_.cy);
  const std::uint64_t key = hash64(hash64(seed_, 9), static_cast<std::uint64_t>(frame));
  const GaussTable& gauss = GaussTable::instance();
  pool.run((exact.height + kStrip - 1) / kStrip, [&](int strip, int) {
    for (int y = strip * kStrip; y < std::min(exact.height, (strip + 1) * kStrip); ++y)
      for (int x = 0; x < exact.width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(exact.width) +
                              static_cast<std::size_t>(x);
        Eigen::Array4f c = exact.color[i];
        const float u = static_cast<float>(x), v = static_cast<float>(y);
        if (model_.exposure_s > 0 && exact.depth[i] > 0) {
          // The image point moves on a line through the pixel: average along it.
          const Eigen::Vector3f q =
              exact.depth[i] * (R * Eigen::Vector3f((u - cx) / fx, (v - cy) / fy, 1)) + t;
          const float inverse = 1 / std::max(q.z(), 0.05f);
          const float du = fx * q.x() * inverse + cx - u, dv = fy * q.y() * inverse + cy - v;
          const float length = 2 * std::sqrt(du * du + dv * dv);
          if (length > 0.3f) {
            const int samples = std::clamp(static_cast<int>(length) + 2, 2, 8);
            c.setZero();
            for (int k = 0; k < samples; ++k) {
              const float s = (2 * static_cast<float>(k) + 1) / static_cast<float>(samples) - 1;
              c += bilinear(exact, u + s * du, v + s * dv);
            }
            c /= static_cast<float>(samples);
          }
        }
        c *= 255 * gain;
        if (model_.color_sigma > 0) {
          const std::uint64_t h = hash64(key + i);
          c += model_.color_sigma * Eigen::Array4f(gauss(h, 0), gauss(h, 1), gauss(h, 2), 0);
        }
        c = c.max(0.f).min(255.f) + 0.5f;
        image(x, y) = {static_cast<std::uint8_t>(c[0]), static_cast<std::uint8_t>(c[1]),
                       static_cast<std::uint8_t>(c[2])};
      }
  });
  return image;
}

}  // namespace sgs::synthetic
