// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/image_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sgs/eval/ssim_kernel.h"

namespace sgs::eval {
namespace {

using render::Rgbf;

constexpr std::array<float Rgbf::*, 3> kChannels = {&Rgbf::r, &Rgbf::g, &Rgbf::b};

void check_same_size(const ColorFloatImage& a, const ColorFloatImage& b) {
  SGS_CHECK(a.width() == b.width() && a.height() == b.height(), "pictures differ in size");
}

std::array<double, kSsimWindow> gaussian_window() {
  constexpr double kSigma = 1.5;
  std::array<double, kSsimWindow> w{};
  double sum = 0;
  for (int i = 0; i < kSsimWindow; ++i) {
    w[static_cast<std::size_t>(i)] =
        std::exp(-0.5 * (i - kSsimRadius) * (i - kSsimRadius) / (kSigma * kSigma));
    sum += w[static_cast<std::size_t>(i)];
  }
  std::array<double, kSsimWindow> result{};
  for (std::size_t i = 0; i < kSsimWindow; ++i) result[i] = w[i] / sum;
  return result;
}

/// The arrays of an SsimJob, kept from one channel to the next.
struct SsimMemory {
  std::vector<double> x, y;
  std::array<std::vector<double>, 5> moments;

  SsimMemory(std::size_t pixels, std::size_t width)
      : x(pixels + kSsimPadding), y(pixels + kSsimPadding) {
    moments.fill(std::vector<double>(width + kSsimPadding));
  }
};

/// Mean of the SSIM map over the interior of one channel.
double channel_ssim(SsimMemory& memory, int width, int height) {
  static const std::array<double, kSsimWindow> weight = gaussian_window();
  SsimJob job;
  job.x = memory.x.data();
  job.y = memory.y.data();
  job.width = static_cast<std::size_t>(width);
  job.height = static_cast<std::size_t>(height);
  job.weight = weight.data();
  for (std::size_t m = 0; m < memory.moments.size(); ++m) job.moments[m] = memory.moments[m].data();
  return ssim_sum(job) /
         (static_cast<double>(width - 2 * kSsimRadius) * (height - 2 * kSsimRadius));
}

/// Windows in which nothing was seen.
double blank_windows(const PixelMask& seen) {
  const int width = seen.width(), height = seen.height();
  std::vector<int> in_column(static_cast<std::size_t>(width), 0);  // seen pixels of 11 rows
  double blank = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int& sum = in_column[static_cast<std::size_t>(x)];
      sum += seen(x, y);
      if (y >= kSsimWindow) sum -= seen(x, y - kSsimWindow);
    }
    if (y < kSsimWindow - 1) continue;
    int in_window = 0;
    for (int x = 0; x < width; ++x) {
      in_window += in_column[static_cast<std::size_t>(x)];
      if (x >= kSsimWindow) in_window -= in_column[static_cast<std::size_t>(x - kSsimWindow)];
      if (x >= kSsimWindow - 1 && in_window == 0) ++blank;
    }
  }
  return blank;
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

ColorFloatImage brightened(const ColorFloatImage& image, const std::array<float, 3>& gain) {
  ColorFloatImage out = image;
  for (std::size_t i = 0; i < out.size(); ++i) {
    render::Rgbf& p = out.data()[i];
    p = {gain[0] * p.r, gain[1] * p.g, gain[2] * p.b};
  }
  return out;
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

double psnr_db(const ColorFloatImage& truth, const ColorFloatImage& image, const PixelMask* seen) {
  check_same_size(truth, image);
  SGS_CHECK(!truth.empty(), "PSNR of empty pictures");
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (seen != nullptr && seen->data()[i] == 0) continue;
    ++count;
    for (const auto channel : kChannels) {
      const double d = static_cast<double>(truth.data()[i].*channel) - image.data()[i].*channel;
      sum += d * d;
    }
  }
  if (count == 0) return 0;
  const double mse = sum / (3.0 * static_cast<double>(count));
  return mse > 0 ? std::min(kMaxPsnr_db, -10 * std::log10(mse)) : kMaxPsnr_db;
}

ColorFloatImage zero_unseen(const ColorFloatImage& image, const PixelMask* seen) {
  ColorFloatImage result = image;
  for (std::size_t i = 0; seen != nullptr && i < image.size(); ++i) {
    if (seen->data()[i] == 0) result.data()[i] = Rgbf{};
  }
  return result;
}

std::optional<double> ssim(const ColorFloatImage& truth, const ColorFloatImage& image,
                           const PixelMask* seen) {
  check_same_size(truth, image);
  if (truth.width() < kSsimWindow || truth.height() < kSsimWindow) return std::nullopt;
  if (seen != nullptr) {
    const double all =
        static_cast<double>(truth.width() - 2 * kSsimRadius) * (truth.height() - 2 * kSsimRadius);
    const double blank = blank_windows(*seen);
    if (blank == all) return std::nullopt;
    // Two black windows are alike: SSIM 1.
    const auto mean = ssim(zero_unseen(truth, seen), zero_unseen(image, seen));
    return (*mean * all - blank) / (all - blank);
  }
  SsimMemory memory(truth.size(), static_cast<std::size_t>(truth.width()));
  double sum = 0;
  for (const auto channel : kChannels) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      memory.x[i] = truth.data()[i].*channel;
      memory.y[i] = image.data()[i].*channel;
    }
    sum += channel_ssim(memory, truth.width(), truth.height());
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
