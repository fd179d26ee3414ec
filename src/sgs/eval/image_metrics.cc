// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/image_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sgs::eval {
namespace {

using render::Rgbf;

constexpr int kRadius = 5;
constexpr int kWindow = 2 * kRadius + 1;
constexpr std::array<float Rgbf::*, 3> kChannels = {&Rgbf::r, &Rgbf::g, &Rgbf::b};

void check_same_size(const ColorFloatImage& a, const ColorFloatImage& b) {
  SGS_CHECK(a.width() == b.width() && a.height() == b.height(), "pictures differ in size");
}

std::array<double, kWindow> gaussian_window() {
  constexpr double kSigma = 1.5;
  std::array<double, kWindow> w{};
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) {
    w[static_cast<std::size_t>(i)] =
        std::exp(-0.5 * (i - kRadius) * (i - kRadius) / (kSigma * kSigma));
    sum += w[static_cast<std::size_t>(i)];
  }
  std::array<double, kWindow> result{};
  for (std::size_t i = 0; i < kWindow; ++i) result[i] = w[i] / sum;
  return result;
}

/// In double, as small variances are differences of large moments. Weighted means of x, y, x^2, y^2
/// and xy over the window's columns, for one row.
struct Moments {
  static constexpr int kCount = 5;
  std::array<std::vector<double>, kCount> row;
  explicit Moments(std::size_t width) { row.fill(std::vector<double>(width)); }
};

/// Vertical pass of the five moments for the window of rows starting at `top`.
void vertical_pass(const std::vector<double>& x, const std::vector<double>& y, int width, int top,
                   const std::array<double, kWindow>& weight, Moments& out) {
  for (auto& row : out.row) std::fill(row.begin(), row.end(), 0.0);
  for (int k = 0; k < kWindow; ++k) {
    const double w = weight[static_cast<std::size_t>(k)];
    const std::size_t offset = static_cast<std::size_t>(top + k) * static_cast<std::size_t>(width);
    const double *px = x.data() + offset, *py = y.data() + offset;
    double *mx = out.row[0].data(), *my = out.row[1].data(), *mxx = out.row[2].data(),
           *myy = out.row[3].data(), *mxy = out.row[4].data();
    for (int i = 0; i < width; ++i) {
      const double wx = w * px[i], wy = w * py[i];
      mx[i] += wx;
      my[i] += wy;
      mxx[i] += wx * px[i];
      myy[i] += wy * py[i];
      mxy[i] += wx * py[i];
    }
  }
}

void horizontal_pass(const std::vector<double>& in, int width, const std::array<double, kWindow>& w,
                     std::vector<double>& out) {
  std::fill(out.begin(), out.end(), 0.0);
  for (int k = 0; k < kWindow; ++k) {
    const double* p = in.data() + k;
    for (int i = 0; i < width - 2 * kRadius; ++i) {
      out[static_cast<std::size_t>(i)] += w[static_cast<std::size_t>(k)] * p[i];
    }
  }
}

/// Mean of the SSIM map over the interior of one channel (Wang et al. 2004, eq. 13).
double channel_ssim(const std::vector<double>& x, const std::vector<double>& y, int width,
                    int height) {
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
  static const std::array<double, kWindow> weight = gaussian_window();
  Moments column(static_cast<std::size_t>(width)), full(static_cast<std::size_t>(width));
  double sum = 0;
  for (int top = 0; top + kWindow <= height; ++top) {
    vertical_pass(x, y, width, top, weight, column);
    for (std::size_t m = 0; m < Moments::kCount; ++m) {
      horizontal_pass(column.row[m], width, weight, full.row[m]);
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(width - 2 * kRadius); ++i) {
      const double ux = full.row[0][i], uy = full.row[1][i];
      const double vx = full.row[2][i] - ux * ux, vy = full.row[3][i] - uy * uy;
      const double vxy = full.row[4][i] - ux * uy;
      sum +=
          (((2 * ux * uy + kC1) * (2 * vxy + kC2)) / ((ux * ux + uy * uy + kC1) * (vx + vy + kC2)));
    }
  }
  return sum / (static_cast<double>(width - 2 * kRadius) * (height - 2 * kRadius));
}

}  // namespace

ColorFloatImage to_float(const ColorImage& image) {
  ColorFloatImage result(image.width(), image.height());
  constexpr float kScale = 1.0f / 255.0f;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const Rgb8& c = image.data()[i];
    result.data()[i] = {kScale * c.r, kScale * c.g, kScale * c.b};
  }
  return result;
}

ColorFloatImage clamped(const ColorFloatImage& image) {
  ColorFloatImage result(image.width(), image.height());
  for (std::size_t i = 0; i < image.size(); ++i) {
    for (const auto channel : kChannels) {
      const float v = image.data()[i].*channel;
      result.data()[i].*channel = std::isfinite(v) ? std::clamp(v, 0.0f, 1.0f) : 0.0f;
    }
  }
  return result;
}

ColorFloatImage zero_without_depth(const ColorFloatImage& image, const DepthImage& depth) {
  SGS_CHECK(image.width() == depth.width() && image.height() == depth.height(),
            "picture and depth differ in size");
  ColorFloatImage result = image;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (!(depth.data()[i] > 0)) result.data()[i] = Rgbf{};
  }
  return result;
}

double psnr_db(const ColorFloatImage& truth, const ColorFloatImage& image) {
  check_same_size(truth, image);
  SGS_CHECK(!truth.empty(), "PSNR of empty pictures");
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (const auto channel : kChannels) {
      const double d = static_cast<double>(truth.data()[i].*channel) - image.data()[i].*channel;
      sum += d * d;
    }
  }
  const double mse = sum / (3.0 * static_cast<double>(truth.size()));
  return mse > 0 ? std::min(kMaxPsnr_db, -10 * std::log10(mse)) : kMaxPsnr_db;
}

std::optional<double> ssim(const ColorFloatImage& truth, const ColorFloatImage& image) {
  check_same_size(truth, image);
  if (truth.width() < kWindow || truth.height() < kWindow) return std::nullopt;
  std::vector<double> x(truth.size()), y(truth.size());
  double sum = 0;
  for (const auto channel : kChannels) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      x[i] = truth.data()[i].*channel;
      y[i] = image.data()[i].*channel;
    }
    sum += channel_ssim(x, y, truth.width(), truth.height());
  }
  return sum / 3;
}

std::optional<DepthError> depth_error(const DepthImage& measured,
                                      const render::Rendering& rendering, float min_alpha) {
  SGS_CHECK(
      measured.size() == rendering.depth_sum.size() && measured.size() == rendering.alpha.size(),
      "measured and rendered depth differ in size");
  std::size_t valid = 0, compared = 0;
  double sum = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const float z = measured.data()[i], alpha = rendering.alpha.data()[i];
    if (!(z > 0)) continue;
    ++valid;
    if (!(alpha >= min_alpha && alpha > 0)) continue;
    const double depth = static_cast<double>(rendering.depth_sum.data()[i]) / alpha;
    if (!std::isfinite(depth)) continue;
    ++compared;
    sum += std::abs(depth - z);
  }
  if (compared == 0) return std::nullopt;
  return DepthError{sum / static_cast<double>(compared),
                    static_cast<double>(compared) / static_cast<double>(valid)};
}

}  // namespace sgs::eval
