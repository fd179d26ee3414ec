// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/inverse_depth_field.h"

#include <Eigen/LU>
#include <cmath>

#include "sgs/camera/depth_noise.h"

namespace sgs::registration {
namespace {

constexpr int kRaster = 4;             // pixels between the planes
constexpr float kLeastSupport = 0.8f;  // of a window that shows one surface only

constexpr int kSlopeReach = 3;    // cells on either side that a slope is fitted to
constexpr int kFewestCells = 20;  // of them that must lie on the surface
// And their share: beside a crease a window is the mean of two surfaces, in a room's corners one
// that is always too near. Pictures have their contrast there.
constexpr float kLeastShare = 0.8f;
constexpr int kBorderCells = 2;  // whose windows reach beyond the image

bool on_border(const Image<InverseDepthPlane>& planes, int x, int y) {
  return x < kBorderCells || y < kBorderCells || x >= planes.width() - kBorderCells ||
         y >= planes.height() - kBorderCells;
}

/// The slope of a surface around a cell, from the cells that continue it. That of one window alone
/// is mostly noise, and a residual's derivative that is noise hides how little is known.
InverseDepthPlane with_slope_around(const Image<InverseDepthPlane>& planes, int x, int y) {
  const InverseDepthPlane& centre = planes(x, y);
  if (centre.q <= 0) return {};
  const float z = 1 / centre.q;
  const float sigma_q = depth_sigma_m(z) * centre.q * centre.q;
  Eigen::Matrix3f A = Eigen::Matrix3f::Zero();
  Eigen::Vector3f b = Eigen::Vector3f::Zero();
  int cells = 0, looked_at = 0;
  for (int j = std::max(0, y - kSlopeReach); j <= std::min(planes.height() - 1, y + kSlopeReach);
       ++j) {
    for (int i = std::max(0, x - kSlopeReach); i <= std::min(planes.width() - 1, x + kSlopeReach);
         ++i) {
      if (!on_border(planes, i, j)) ++looked_at;
      const float q = planes(i, j).q;
      if (q <= 0) continue;
      const auto du = static_cast<float>(kRaster * (i - x)),
                 dv = static_cast<float>(kRaster * (j - y));
      const float gate = sigma_q * (1 + std::hypot(du, dv) / (2 * kRaster));
      const float off = q - centre.q;
      if (std::abs(off - centre.slope_u * du - centre.slope_v * dv) > gate) continue;
      const Eigen::Vector3f row(du, dv, 1);
      A += row * row.transpose();
      b += off * row;
      ++cells;
    }
  }
  if (cells < kFewestCells ||
      static_cast<float>(cells) < kLeastShare * static_cast<float>(looked_at))
    return {};
  if (std::abs(A.determinant()) < 1) return {};
  const Eigen::Vector3f fit = A.inverse() * b;
  return {centre.q, fit.x(), fit.y(), centre.support};
}

}  // namespace

InverseDepthField::InverseDepthField(const DepthImage& depth, const PinholeCamera& camera)
    : planes_(depth.width() / kRaster, depth.height() / kRaster) {
  Image<InverseDepthPlane> windows = planes_;
  PlaneFitSampler sampler({}, camera);
  sampler.set_depth(depth);
  for (int y = 0; y < planes_.height(); ++y) {
    for (int x = 0; x < planes_.width(); ++x) {
      const InverseDepthPlane plane = sampler.inverse_depth_plane(kRaster * x, kRaster * y);
      if (plane.support >= kLeastSupport) windows(x, y) = plane;
    }
  }
  for (int y = 0; y < planes_.height(); ++y) {
    for (int x = 0; x < planes_.width(); ++x) planes_(x, y) = with_slope_around(windows, x, y);
  }
}

InverseDepthPlane InverseDepthField::at(double u, double v) const {
  const int x = static_cast<int>(std::floor(u / kRaster + 0.5));
  const int y = static_cast<int>(std::floor(v / kRaster + 0.5));
  if (!planes_.contains(x, y)) return {};
  InverseDepthPlane plane = planes_(x, y);
  if (plane.q <= 0) return {};
  plane.q += plane.slope_u * static_cast<float>(u - kRaster * x) +
             plane.slope_v * static_cast<float>(v - kRaster * y);
  return plane.q > 0 ? plane : InverseDepthPlane{};
}

}  // namespace sgs::registration
