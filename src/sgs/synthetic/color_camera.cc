// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/color_camera.h"

#include <algorithm>
#include <cmath>

#include "sgs/synthetic/random.h"

namespace sgs::synthetic {

namespace {

constexpr int kPictureRows = 16;
constexpr int kCurveSteps = 4096;

template <class Row>
void for_rows(int height, ThreadPool& pool, const Row& row) {
  pool.run((height + kPictureRows - 1) / kPictureRows, [&](int strip, int) {
    for (int y = strip * kPictureRows; y < std::min(height, (strip + 1) * kPictureRows); ++y)
      row(y);
  });
}

// Which of red, green and blue a pixel's filter lets through: G R over B G.
std::size_t filter_at(int x, int y) {
  if ((x + y) % 2 == 0) return 1;
  return y % 2 == 0 ? 0 : 2;
}

Eigen::Array4f light_at(const std::vector<Eigen::Array4f>& image, int width, int height, float x,
                        float y) {
  x = std::clamp(x, 0.f, static_cast<float>(width) - 1.001f);
  y = std::clamp(y, 0.f, static_cast<float>(height) - 1.001f);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const Eigen::Array4f* c = image.data() + std::ptrdiff_t{y0} * width + x0;
  const Eigen::Array4f top = c[0] + fx * (c[1] - c[0]);
  const Eigen::Array4f bottom = c[width] + fx * (c[width + 1] - c[width]);
  return top + fy * (bottom - top);
}

// From the straight line towards an S with flat ends.
float steeper(float v, float share) { return v + share * (v * v * (3 - 2 * v) - v); }

// Index within 0 .. n - 1, mirrored at the border, which keeps the filters' pattern.
int mirrored(int i, int n) { return i < 0 ? -i : (i >= n ? 2 * n - 2 - i : i); }

}  // namespace

ColorCamera::ColorCamera(const ResponseModel& model, std::shared_ptr<const LensRays> lens,
                         std::uint64_t seed)
    : model_(model),
      lens_(std::move(lens)),
      seed_(hash64(seed, hash_name("colour camera"))),
      width_(lens_->camera().camera.width),
      height_(lens_->camera().camera.height) {
  curve_.reserve(kCurveSteps + 1);
  for (int k = 0; k <= kCurveSteps; ++k) {
    const float root = static_cast<float>(k) / kCurveSteps;
    const float power = std::pow(root, 2 * model.gamma);
    const float once = steeper(power, std::min(model.contrast, 1.f));
    curve_.push_back(steeper(once, std::max(model.contrast - 1, 0.f)));
  }
}

float ColorCamera::grey(float light) const {
  const float root = std::sqrt(std::clamp(light, 0.f, 1.f));
  return curve_[static_cast<std::size_t>(root * kCurveSteps + 0.5f)];
}

// Falls with the square of the distance from the middle.
float ColorCamera::vignette(int x, int y) const {
  const float dx = 2 * static_cast<float>(x) / static_cast<float>(width_) - 1;
  const float dy = 2 * static_cast<float>(y) / static_cast<float>(height_) - 1;
  return 1 - model_.vignetting * 0.5f * (dx * dx + dy * dy);
}

// Of what the filter of one colour lets through, a part is light of all colours.
float ColorCamera::filtered(const Eigen::Array4f& light, std::size_t channel) const {
  const float all = 0.299f * light[0] + 0.587f * light[1] + 0.114f * light[2];
  const float own = light[static_cast<Eigen::Index>(channel)];
  return model_.cast[channel] * (own + model_.crosstalk * (all - own));
}

std::array<double, 3> ColorCamera::meter(const RayImage& view, const Exposure& exposure) const {
  constexpr int kStep = 8;
  std::array<double, 3> sum{};
  double weights = 0;
  for (int y = kStep / 2; y < height_; y += kStep)
    for (int x = kStep / 2; x < width_; x += kStep) {
      const bool middle =
          std::abs(2 * x - width_) < width_ / 2 && std::abs(2 * y - height_) < height_ / 2;
      const double weight = middle ? 2 : 1;
      const Eigen::Array4f& c =
          view.color[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                     static_cast<std::size_t>(x)];
      const float gain = exposure.gain * vignette(x, y);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const float raw = std::min(1.f, gain * filtered(c * c, channel));
        sum[channel] += weight * double{grey(raw * exposure.balance[channel])};
      }
      weights += weight;
    }
  for (double& s : sum) s /= weights;
  return sum;
}

// Light averaged along the way that each image point goes during the exposure.
ColorCamera::Light ColorCamera::moved(const RayImage& view, const SE3& half_motion,
                                      ThreadPool& pool) const {
  constexpr float kShortest_px = 0.3f;
  constexpr int kMostSamples = 24;
  Light sharp(view.color.size());
  for_rows(height_, pool, [&](int y) {
    const std::size_t begin = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (std::size_t i = begin; i < begin + static_cast<std::size_t>(width_); ++i)
      sharp[i] = view.color[i] * view.color[i];
  });
  Light out = sharp;
  const Eigen::Matrix3f R = half_motion.R.cast<float>();
  const Eigen::Vector3f t = half_motion.t.cast<float>();
  for_rows(height_, pool, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(x);
      const float depth = view.depth[i];
      if (depth <= 0) continue;
      const Eigen::Vector3f q =
          depth * (R * Eigen::Vector3f(lens_->x(y)[x], lens_->y(y)[x], 1)) + t;
      if (q.z() < 0.05f) continue;
      const Eigen::Vector2f here(static_cast<float>(x), static_cast<float>(y));
      const Eigen::Vector2f half = lens_->pixel(q) - here;
      const float length = 2 * half.norm();
      if (!(length > kShortest_px)) continue;
      const int samples = std::clamp(static_cast<int>(length) + 2, 2, kMostSamples);
      Eigen::Array4f sum = Eigen::Array4f::Zero();
      for (int k = 0; k < samples; ++k) {
        const float s = (2 * static_cast<float>(k) + 1) / static_cast<float>(samples) - 1;
        sum += light_at(sharp, width_, height_, here.x() + s * half.x(), here.y() + s * half.y());
      }
      out[i] = sum / static_cast<float>(samples);
    }
  });
  return out;
}

// The optics' spot, of the given variance: three taps along rows, then along columns.
void ColorCamera::spread(Light& light, ThreadPool& pool) const {
  const float sigma = model_.blur_px * static_cast<float>(width_) / 640;
  const float side = std::min(sigma * sigma / 2, 1.f / 3);
  if (side < 0.01f) return;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  };
  Light rows(light.size());
  for_rows(height_, pool, [&](int y) {
    for (int x = 0; x < width_; ++x)
      rows[at(x, y)] =
          (1 - 2 * side) * light[at(x, y)] +
          side * (light[at(mirrored(x - 1, width_), y)] + light[at(mirrored(x + 1, width_), y)]);
  });
  for_rows(height_, pool, [&](int y) {
    for (int x = 0; x < width_; ++x)
      light[at(x, y)] =
          (1 - 2 * side) * rows[at(x, y)] +
          side * (rows[at(x, mirrored(y - 1, height_))] + rows[at(x, mirrored(y + 1, height_))]);
  });
}

std::vector<float> ColorCamera::mosaic(const Light& light, float gain, std::int64_t frame,
                                       ThreadPool& pool) const {
  std::vector<float> raw(light.size());
  const std::uint64_t key = hash64(seed_, static_cast<std::uint64_t>(frame));
  const GaussTable& gauss = GaussTable::instance();
  const float read = model_.read_noise * model_.read_noise, shot = 1 / model_.full_well;
  for_rows(height_, pool, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(x);
      const float exposed = gain * vignette(x, y) * filtered(light[i], filter_at(x, y));
      const float noise = std::sqrt(read + shot * exposed) * gauss(hash64(key + i), 0);
      raw[i] = std::min(1.f, exposed + noise);
    }
  });
  return raw;
}

// The missing colours of each pixel are the means of the nearest that have them.
ColorImage ColorCamera::developed(const std::vector<float>& raw, const Exposure& exposure,
                                  ThreadPool& pool) const {
  ColorImage image(width_, height_);
  const float black = model_.black + 0.5f, range = 255 - model_.black;
  const auto byte = [&](float value, std::size_t channel) {
    return static_cast<std::uint8_t>(black + range * grey(value * exposure.balance[channel]));
  };
  for_rows(height_, pool, [&](int y) {
    const auto row = [&](int v) {
      return raw.data() + std::ptrdiff_t{mirrored(v, height_)} * width_;
    };
    const float *up = row(y - 1), *here = row(y), *down = row(y + 1);
    for (int x = 0; x < width_; ++x) {
      const int l = mirrored(x - 1, width_), r = mirrored(x + 1, width_);
      const float across = (here[l] + here[r]) / 2, along = (up[x] + down[x]) / 2;
      if (filter_at(x, y) == 1) {
        const bool red_row = y % 2 == 0;
        image(x, y) = {byte(red_row ? across : along, 0), byte(here[x], 1),
                       byte(red_row ? along : across, 2)};
        continue;
      }
      const float diagonal = (up[l] + up[r] + down[l] + down[r]) / 4;
      const bool red = filter_at(x, y) == 0;
      image(x, y) = {byte(red ? here[x] : diagonal, 0), byte((across + along) / 2, 1),
                     byte(red ? diagonal : here[x], 2)};
    }
  });
  return image;
}

// As cameras do it: what each luma has beyond the mean of its four neighbours counts more.
ColorImage ColorCamera::sharpened(const ColorImage& image, ThreadPool& pool) const {
  ColorImage out = image;
  for_rows(height_, pool, [&](int y) {
    const Rgb8 *up = image.row(mirrored(y - 1, height_)), *here = image.row(y),
               *down = image.row(mirrored(y + 1, height_));
    for (int x = 0; x < width_; ++x) {
      const float around = luma(up[x]) + luma(down[x]) + luma(here[mirrored(x - 1, width_)]) +
                           luma(here[mirrored(x + 1, width_)]);
      const float more = model_.sharpening * (luma(here[x]) - around / 4);
      const auto byte = [&](std::uint8_t value) {
        return static_cast<std::uint8_t>(
            std::clamp(static_cast<float>(value) + more, model_.black, 255.f) + 0.5f);
      };
      out(x, y) = {byte(here[x].r), byte(here[x].g), byte(here[x].b)};
    }
  });
  return out;
}

ColorImage ColorCamera::picture(const RayImage& view, const SE3& half_motion,
                                const Exposure& exposure, std::int64_t frame,
                                ThreadPool& pool) const {
  Light light = moved(view, half_motion, pool);
  spread(light, pool);
  const ColorImage image = developed(mosaic(light, exposure.gain, frame, pool), exposure, pool);
  return model_.sharpening > 0 ? sharpened(image, pool) : image;
}

}  // namespace sgs::synthetic
