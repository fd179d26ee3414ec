// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/view_color.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "sgs/core/error.h"

namespace sgs::render {
namespace {

constexpr std::size_t kMostFunctions = map::Harmonics::basis_functions(map::kMaxHarmonicDegree);
using Basis = std::array<float, kMostFunctions>;

/// Values of the basis functions of degrees 1 to `degree` at a unit direction.
void basis(int degree, const Eigen::Vector3f& d, Basis& out) {
  constexpr float k1 = 0.4886025119029199f;
  constexpr float k20 = 1.0925484305920792f, k21 = 0.31539156525252005f, k22 = 0.5462742152960396f;
  constexpr float k30 = 0.5900435899266435f, k31 = 2.890611442640554f, k32 = 0.4570457994644658f,
                  k33 = 0.3731763325901154f, k34 = 1.445305721320277f;
  const float x = d.x(), y = d.y(), z = d.z();
  out[0] = -k1 * y;
  out[1] = k1 * z;
  out[2] = -k1 * x;
  if (degree < 2) return;
  const float xx = x * x, yy = y * y, zz = z * z;
  out[3] = k20 * x * y;
  out[4] = -k20 * y * z;
  out[5] = k21 * (2 * zz - xx - yy);
  out[6] = -k20 * x * z;
  out[7] = k22 * (xx - yy);
  if (degree < 3) return;
  out[8] = -k30 * y * (3 * xx - yy);
  out[9] = k31 * x * y * z;
  out[10] = -k32 * y * (4 * zz - xx - yy);
  out[11] = k33 * z * (2 * zz - 3 * xx - 3 * yy);
  out[12] = -k32 * x * (4 * zz - xx - yy);
  out[13] = k34 * z * (xx - yy);
  out[14] = -k30 * x * (xx - 3 * yy);
}

/// Their gradients by the direction, each of its three numbers taken for free.
void basis_gradients(int degree, const Eigen::Vector3f& d,
                     std::array<Eigen::Vector3f, kMostFunctions>& out) {
  constexpr float k1 = 0.4886025119029199f;
  constexpr float k20 = 1.0925484305920792f, k21 = 0.31539156525252005f, k22 = 0.5462742152960396f;
  constexpr float k30 = 0.5900435899266435f, k31 = 2.890611442640554f, k32 = 0.4570457994644658f,
                  k33 = 0.3731763325901154f, k34 = 1.445305721320277f;
  const float x = d.x(), y = d.y(), z = d.z();
  out[0] = {0, -k1, 0};
  out[1] = {0, 0, k1};
  out[2] = {-k1, 0, 0};
  if (degree < 2) return;
  out[3] = {k20 * y, k20 * x, 0};
  out[4] = {0, -k20 * z, -k20 * y};
  out[5] = {-2 * k21 * x, -2 * k21 * y, 4 * k21 * z};
  out[6] = {-k20 * z, 0, -k20 * x};
  out[7] = {2 * k22 * x, -2 * k22 * y, 0};
  if (degree < 3) return;
  const float xx = x * x, yy = y * y, zz = z * z;
  out[8] = {-6 * k30 * x * y, -3 * k30 * (xx - yy), 0};
  out[9] = {k31 * y * z, k31 * x * z, k31 * x * y};
  out[10] = {2 * k32 * x * y, -k32 * (4 * zz - xx - 3 * yy), -8 * k32 * y * z};
  out[11] = {-6 * k33 * x * z, -6 * k33 * y * z, k33 * (6 * zz - 3 * xx - 3 * yy)};
  out[12] = {-k32 * (4 * zz - 3 * xx - yy), 2 * k32 * x * y, -8 * k32 * x * z};
  out[13] = {2 * k34 * x * z, -2 * k34 * y * z, k34 * (xx - yy)};
  out[14] = {-3 * k30 * (xx - yy), 6 * k30 * x * y, 0};
}

/// From the camera to the mean; zero length where they coincide.
Eigen::Vector3f towards(const map::Gaussian& g, const Eigen::Vector3f& center) {
  return Eigen::Map<const Eigen::Vector3f>(g.mean) - center;
}

constexpr float kLeastDistance_m = 1e-6f;  // nearer than this nothing is drawn anyway

/// Where the colour of a view ends: what depends on the view takes none out of [0, 1] that would
/// not be outside without.
float least(float base) { return std::min(base, 0.0f); }
float most(float base) { return std::max(base, 1.0f); }

}  // namespace

void color_towards(std::span<const map::Gaussian> gaussians, const map::Harmonics& harmonics,
                   const Eigen::Vector3d& center, std::vector<map::Gaussian>& out,
                   ThreadPool* pool) {
  SGS_CHECK(harmonics.size() == gaussians.size(), "harmonics of another map");
  constexpr std::size_t kChunkSize = 4096;
  out.resize(gaussians.size());
  const Eigen::Vector3f from = center.cast<float>();
  const std::size_t functions = map::Harmonics::basis_functions(harmonics.degree);
  const auto color = [&](int chunk, int) {
    const std::size_t first = static_cast<std::size_t>(chunk) * kChunkSize;
    const std::size_t end = std::min(first + kChunkSize, gaussians.size());
    Basis values;
    for (std::size_t i = first; i < end; ++i) {
      map::Gaussian g = gaussians[i];
      const Eigen::Vector3f v = towards(g, from);
      const float distance = v.norm();
      if (distance > kLeastDistance_m) {
        basis(harmonics.degree, v / distance, values);
        const auto c = harmonics.of(i);
        for (std::size_t k = 0; k < functions; ++k) {
          for (std::size_t j = 0; j < 3; ++j) g.rgb[j] += c[3 * k + j] * values[k];
        }
        for (std::size_t j = 0; j < 3; ++j) {
          const float base = gaussians[i].rgb[j];
          g.rgb[j] = std::clamp(g.rgb[j], least(base), most(base));
        }
      }
      out[i] = g;
    }
  };
  const auto chunks = static_cast<int>((gaussians.size() + kChunkSize - 1) / kChunkSize);
  if (pool != nullptr) {
    pool->run(chunks, color);
  } else {
    for (int c = 0; c < chunks; ++c) color(c, 0);
  }
}

void color_backward(const map::Gaussian& gaussian, std::span<const float> coefficients, int degree,
                    const Eigen::Vector3d& center, map::Gaussian& row, std::span<float> gradient) {
  const Eigen::Vector3f v = towards(gaussian, center.cast<float>());
  const float distance = v.norm();
  if (!(distance > kLeastDistance_m)) {
    std::fill(gradient.begin(), gradient.end(), 0.0f);
    return;
  }
  const Eigen::Vector3f d = v / distance;
  const std::size_t functions = map::Harmonics::basis_functions(degree);
  Basis values;
  basis(degree, d, values);
  std::array<Eigen::Vector3f, kMostFunctions> slopes;
  basis_gradients(degree, d, slopes);
  // Beyond the end of its range a colour only follows what takes it back.
  for (std::size_t j = 0; j < 3; ++j) {
    float color = gaussian.rgb[j];
    for (std::size_t k = 0; k < functions; ++k) color += coefficients[3 * k + j] * values[k];
    const bool below = color < least(gaussian.rgb[j]);
    const bool above = color > most(gaussian.rgb[j]);
    if ((below && row.rgb[j] > 0) || (above && row.rgb[j] < 0)) row.rgb[j] = 0;
  }
  Eigen::Vector3f by_direction = Eigen::Vector3f::Zero();
  for (std::size_t k = 0; k < functions; ++k) {
    float pull = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      gradient[3 * k + j] = row.rgb[j] * values[k];
      pull += row.rgb[j] * coefficients[3 * k + j];
    }
    by_direction += pull * slopes[k];
  }
  // Along the ray the direction stays.
  const Eigen::Vector3f by_mean = (by_direction - d.dot(by_direction) * d) / distance;
  for (int j = 0; j < 3; ++j) row.mean[j] += by_mean[j];
}

void turn_harmonics(const Eigen::Matrix3d& R, map::Harmonics& harmonics) {
  if (harmonics.empty()) return;
  // Found from values at directions spread over the sphere: more than there are functions.
  constexpr int kDirections = 48;
  constexpr double kGoldenAngle = 2.399963229728653;
  const auto functions = static_cast<Eigen::Index>(harmonics.basis_functions(harmonics.degree));
  Eigen::MatrixXd there(kDirections, functions), before(kDirections, functions);
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, r = std::sqrt(1 - z * z);
    const Eigen::Vector3d d(r * std::cos(kGoldenAngle * i), r * std::sin(kGoldenAngle * i), z);
    Basis values{};
    basis(harmonics.degree, d.cast<float>(), values);
    for (Eigen::Index k = 0; k < functions; ++k) there(i, k) = values[static_cast<std::size_t>(k)];
    basis(harmonics.degree, (R.transpose() * d).cast<float>(), values);
    for (Eigen::Index k = 0; k < functions; ++k) before(i, k) = values[static_cast<std::size_t>(k)];
  }
  const Eigen::MatrixXf turned = there.colPivHouseholderQr().solve(before).cast<float>();
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    // Red, green and blue of a function lie side by side.
    Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>> c(harmonics.of(i).data(),
                                                                           functions, 3);
    c = (turned * c).eval();
  }
}

}  // namespace sgs::render
