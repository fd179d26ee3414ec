// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sgs/render/rasterizer.h"

namespace sgs::render::reference {

/// Number of optimised parameters of a Gaussian, in the order of map::Gaussian.
inline constexpr std::size_t kParameters = 14;
using Parameters = std::array<double, kParameters>;

Parameters to_parameters(const map::Gaussian& gaussian);

/// A Gaussian as the image sees it.
struct ImageSplat {
  std::size_t source = 0;  ///< row of the parameters
  double x = 0, y = 0;     ///< mean, pixels
  double conic_xx = 0, conic_xy = 0, conic_yy = 0;
  double log2_opacity = 0;
  double extent_x = 0, extent_y = 0;  ///< half size of the box outside which alpha < 1/255
  double z = 0;
  std::array<double, 3> rgb{};
};

/// Composited pixel: colour, depth sum, alpha; and the gradient of the loss in the same order.
using Pixel = std::array<double, 5>;
using PixelImage = std::vector<Pixel>;  // row-major

struct Evaluation {
  double loss = 0;
  std::vector<Parameters> gradient;    ///< one row per Gaussian, zero where invisible
  std::vector<bool> visible, reached;  ///< reached: weighs enough in some pixel
  Vector6d camera_twist = Vector6d::Zero();
  std::array<double, 3> exposure_measured{}, exposure_rendered{};
  PixelImage image;
};

/// Visible Gaussians among the candidates (null = all), nearest first.
std::vector<ImageSplat> project_all(std::span<const Parameters> gaussians,
                                    const PinholeCamera& camera, const SE3& T_world_camera,
                                    const map::GaussianSet* candidates = nullptr);
PixelImage composite(std::span<const ImageSplat> splats, const PinholeCamera& camera,
                     double min_transmittance = kMinTransmittance);
/// Value of the loss, and its gradient with respect to each pixel into `gradient`.
double image_loss(const PixelImage& image, const TrainingImage& training, const LossConfig& loss,
                  PixelImage& gradient);
/// Value and gradient of sum over pixels of (1 - SSIM(x, y)) with respect to x for one channel.
double dssim(std::span<const double> x, std::span<const double> y, int width, int height,
             std::vector<double>& gradient);

Evaluation evaluate(std::span<const Parameters> gaussians, const TrainingImage& training,
                    const SE3& T_world_camera, const LossConfig& loss,
                    const EvaluateOptions& options = {}, bool backward = true);

}  // namespace sgs::render::reference
