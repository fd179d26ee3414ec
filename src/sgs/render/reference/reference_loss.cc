// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sgs/render/reference/reference_scene.h"

namespace sgs::render::reference {
namespace {

constexpr int kRadius = 5;

/// The 11x11 Gaussian window of SSIM applied to a zero-padded image, written as it reads.
std::vector<double> blur(std::span<const double> image, int width, int height) {
  std::array<double, 2 * kRadius + 1> taps{};
  double total = 0;
  for (int i = -kRadius; i <= kRadius; ++i) {
    total += taps[static_cast<std::size_t>(i + kRadius)] = std::exp(-i * i / (2 * 1.5 * 1.5));
  }
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  std::vector<double> rows(image.size()), out(image.size());
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0;
        for (int i = -kRadius; i <= kRadius; ++i) {
          const int sx = pass == 0 ? x + i : x, sy = pass == 0 ? y : y + i;
          if (sx < 0 || sy < 0 || sx >= width || sy >= height) continue;
          sum += taps[static_cast<std::size_t>(i + kRadius)] / total *
                 (pass == 0 ? image[at(sx, sy)] : rows[at(sx, sy)]);
        }
        (pass == 0 ? rows : out)[at(x, y)] = sum;
      }
    }
  }
  return out;
}

/// Huber's loss with slopes of at most 1; |e| where the knee is 0.
double rounded_abs(double e, double knee) {
  const double a = std::abs(e);
  return a < knee ? e * e / (2 * knee) : a - knee / 2;
}

double slope(double e, double knee) {
  if (std::abs(e) < knee) return e / knee;
  return e > 0 ? 1 : (e < 0 ? -1 : 0);
}

}  // namespace

double dssim(std::span<const double> x, std::span<const double> y, int width, int height,
             std::vector<double>& gradient) {
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
  const std::size_t n = x.size();
  std::vector<double> xx(n), xy(n), yy(n);
  for (std::size_t i = 0; i < n; ++i) {
    xx[i] = x[i] * x[i];
    xy[i] = x[i] * y[i];
    yy[i] = y[i] * y[i];
  }
  const auto mx = blur(x, width, height), my = blur(y, width, height);
  const auto exx = blur(xx, width, height), exy = blur(xy, width, height);
  const auto eyy = blur(yy, width, height);
  // SSIM = A1 A2 / (B1 B2), Wang et al. 2004, eq. 13; its derivatives by the window's moments.
  std::vector<double> d_mx(n), d_exx(n), d_exy(n);
  double value = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double A1 = 2 * mx[i] * my[i] + kC1, A2 = 2 * (exy[i] - mx[i] * my[i]) + kC2;
    const double B1 = mx[i] * mx[i] + my[i] * my[i] + kC1;
    const double B2 = exx[i] - mx[i] * mx[i] + eyy[i] - my[i] * my[i] + kC2;
    const double s = A1 * A2 / (B1 * B2);
    value += 1 - s;
    d_exx[i] = -s / B2;
    d_exy[i] = 2 * A1 / (B1 * B2);
    d_mx[i] =
        2 * my[i] * A2 / (B1 * B2) - 2 * mx[i] * s / B1 - 2 * mx[i] * d_exx[i] - my[i] * d_exy[i];
  }
  const auto g_mx = blur(d_mx, width, height), g_exx = blur(d_exx, width, height);
  const auto g_exy = blur(d_exy, width, height);
  gradient.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    gradient[i] = -(g_mx[i] + 2 * x[i] * g_exx[i] + y[i] * g_exy[i]);
  }
  return value;
}

double image_loss(const PixelImage& image, const TrainingImage& training, const LossConfig& loss,
                  PixelImage& gradient) {
  const std::size_t n = image.size();
  gradient.assign(n, Pixel{});
  double value = 0;
  std::array<std::vector<double>, 3> x, y;
  for (std::size_t i = 0; i < n; ++i) {
    const Pixel& p = image[i];
    Pixel& g = gradient[i];
    const Rgbf& c = training.color.data()[i];
    const std::array<double, 3> measured = {c.r, c.g, c.b};
    const double z = training.depth.data()[i];
    const bool counts = loss.color_only_where_depth ? z > 0 : z >= 0;
    const double w = counts ? double{loss.color_weight} / 3 : 0.0;
    const bool seen = z >= 0;  // what was not is as the space around the image is
    for (std::size_t k = 0; k < 3; ++k) {
      const double gain = loss.gain[k], e = gain * p[k] - measured[k];
      value += w * rounded_abs(e, loss.color_knee);
      g[k] = w * gain * slope(e, loss.color_knee);
      x[k].push_back(seen ? gain * p[k] : 0);
      y[k].push_back(seen ? measured[k] : 0);
    }
    if (!(z > 0)) continue;
    const bool relative = loss.depth_form == DepthForm::kAlphaRelative;
    const double e = relative ? p[3] - p[4] * z : p[3] - z;
    const double wd = relative ? loss.depth_weight / std::max(z, 0.3) : double{loss.depth_weight};
    value += wd * rounded_abs(e, loss.depth_knee_m);
    g[3] = wd * slope(e, loss.depth_knee_m);
    if (relative) g[4] = -z * g[3];
  }
  if (loss.dssim_weight == 0.0f) return value;
  const double w = double{loss.dssim_weight} / 3;
  std::vector<double> d;
  for (std::size_t k = 0; k < 3; ++k) {
    value += w * dssim(x[k], y[k], training.camera.width, training.camera.height, d);
    for (std::size_t i = 0; i < n; ++i) {
      if (training.depth.data()[i] >= 0) gradient[i][k] += w * double{loss.gain[k]} * d[i];
    }
  }
  return value;
}

}  // namespace sgs::render::reference
