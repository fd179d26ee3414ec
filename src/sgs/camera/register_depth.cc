// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/register_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgs {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
/// Nearer to the colour camera no point is drawn: its patch would have no bounds.
constexpr float kNearest_m = 0.01f;
/// Neighbours are one surface up to this slope (of a plane seen at 80 degrees) plus noise.
constexpr double kSteepest = 5.7, kNoise = 0.02;

/// Direction of a pixel at depth 1, or NaN where the lens model has none.
Eigen::Vector3d pixel_ray(const LensCamera& lens, double u, double v) {
  const PinholeCamera& k = lens.camera;
  const Eigen::Vector2d seen((u - k.cx) / k.fx, (v - k.cy) / k.fy);
  if (lens.distortion.is_zero()) return {seen.x(), seen.y(), 1};
  const auto straight = lens.distortion.invert(seen);
  if (!straight) return Eigen::Vector3d::Constant(kNan);
  return {straight->x(), straight->y(), 1};
}

/// Bounds of the undistorted image coordinates that a camera sees. Beyond its image a lens model is
/// an extrapolation that may fold back into the image.
void find_field(const LensCamera& lens, Eigen::Vector2d& low, Eigen::Vector2d& high) {
  constexpr double kMargin_px = 1;
  const double w = lens.camera.width - 1 + kMargin_px, h = lens.camera.height - 1 + kMargin_px;
  low.setConstant(std::numeric_limits<double>::max());
  high = -low;
  const auto add = [&](double u, double v) {
    const Eigen::Vector3d ray = pixel_ray(lens, u, v);
    if (!ray.allFinite()) return;
    low = low.cwiseMin(ray.head<2>());
    high = high.cwiseMax(ray.head<2>());
  };
  for (double u = -kMargin_px; u <= w; ++u) add(u, -kMargin_px), add(u, h);
  for (double v = -kMargin_px; v <= h; ++v) add(-kMargin_px, v), add(w, v);
}

/// 1 / depth, 0 where there is none.
DepthImage inverted(const DepthImage& depth) {
  DepthImage out(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    out.data()[i] = depth.data()[i] > 0 ? 1 / depth.data()[i] : 0.0f;
  }
  return out;
}

}  // namespace

DepthRegistration::DepthRegistration(const LensCamera& depth_camera, const LensCamera& color_camera,
                                     const SE3& T_color_depth)
    : color_(color_camera),
      width_(depth_camera.camera.width),
      height_(depth_camera.camera.height),
      offset_(T_color_depth.t.cast<float>()) {
  const PinholeCamera &from = depth_camera.camera, &to = color_camera.camera;
  SGS_CHECK(from.valid() && to.valid(), "incomplete calibration");
  SGS_CHECK(T_color_depth.all_finite(), "the transform is not finite");
  same_surface_ = static_cast<float>(kNoise + kSteepest / std::min(from.fx, from.fy));
  largest_patch_px_ = static_cast<float>(4 * (1 + std::max(to.fx / from.fx, to.fy / from.fy)));
  find_field(color_camera, field_min_, field_max_);
  corners_.reserve(static_cast<std::size_t>(width_ + 1) * (height_ + 1));
  for (int v = 0; v <= height_; ++v) {
    for (int u = 0; u <= width_; ++u) {
      const Eigen::Vector3d ray = pixel_ray(depth_camera, u - 0.5, v - 0.5);
      corners_.push_back((T_color_depth.R * ray).cast<float>());
    }
  }
  depth_factors_.reserve(static_cast<std::size_t>(width_) * height_);
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) {
      const Eigen::Vector3d ray = pixel_ray(depth_camera, u, v);
      depth_factors_.push_back(static_cast<float>((T_color_depth.R * ray).z()));
    }
  }
}

/// Pixel of the point on a ray; NaN where the colour camera cannot see it. Homogeneous coordinates
/// may be scaled, so that the inverse depth does without a division.
Eigen::Vector2f DepthRegistration::project(const Eigen::Vector3f& direction,
                                           float inverse_depth) const {
  const Eigen::Vector3f p = direction + inverse_depth * offset_;
  if (!(p.z() > kNearest_m * inverse_depth)) return {kNan, kNan};
  const PinholeCamera& k = color_.camera;
  const float x = p.x() / p.z(), y = p.y() / p.z();
  if (color_.distortion.is_zero()) {
    return {static_cast<float>(k.fx) * x + static_cast<float>(k.cx),
            static_cast<float>(k.fy) * y + static_cast<float>(k.cy)};
  }
  const Eigen::Vector2d straight(x, y);
  if ((straight.array() < field_min_.array()).any() ||
      (straight.array() > field_max_.array()).any()) {
    return {kNan, kNan};
  }
  const Eigen::Vector2d bent = color_.distortion.apply(straight);
  return {static_cast<float>(k.fx * bent.x() + k.cx), static_cast<float>(k.fy * bent.y() + k.cy)};
}

/// Where the corners above pixel row `row` lie that four pixels of one surface share: at the mean
/// of their inverse depths, which is exact on a plane. NaN for all other corners.
void DepthRegistration::project_joints(const DepthImage& inverse_depth, int row,
                                       std::vector<Eigen::Vector2f>& joints) const {
  joints.assign(width_ + 1, Eigen::Vector2f(kNan, kNan));
  if (row == 0 || row == height_) return;
  const float* above = inverse_depth.row(row - 1);
  const float* below = inverse_depth.row(row);
  const Eigen::Vector3f* corners = corners_.data() + static_cast<std::size_t>(row) * (width_ + 1);
  for (int u = 1; u < width_; ++u) {
    const float a = above[u - 1], b = above[u], c = below[u - 1], d = below[u];
    const float low = std::min(std::min(a, b), std::min(c, d));
    const float high = std::max(std::max(a, b), std::max(c, d));
    if (low > 0 && high - low <= same_surface_ * high) {
      joints[u] = project(corners[u], 0.25f * (a + b + c + d));
    }
  }
}

/// Pixels whose centre lies in the box take `depth` if nothing nearer is there.
void DepthRegistration::draw(const Box& box, float depth, DepthImage& out) const {
  // Also refuses NaN: a corner that the colour camera does not see.
  if (!(box.right - box.left <= largest_patch_px_ && box.bottom - box.top <= largest_patch_px_)) {
    return;
  }
  const auto first = [](float edge, int end) {
    return static_cast<int>(std::ceil(std::clamp(edge, 0.0f, static_cast<float>(end))));
  };
  const int x0 = first(box.left, out.width()), x1 = first(box.right, out.width());
  const int y0 = first(box.top, out.height()), y1 = first(box.bottom, out.height());
  for (int y = y0; y < y1; ++y) {
    float* row = out.row(y);
    for (int x = x0; x < x1; ++x) {
      if (row[x] == 0 || depth < row[x]) row[x] = depth;
    }
  }
}

DepthImage DepthRegistration::operator()(const DepthImage& depth) const {
  SGS_CHECK(depth.width() == width_ && depth.height() == height_,
            "image size differs from the calibration");
  const DepthImage inverse = inverted(depth);
  DepthImage out(color_.camera.width, color_.camera.height);
  std::vector<Eigen::Vector2f> upper, lower;
  project_joints(inverse, 0, upper);
  for (int v = 0; v < height_; ++v) {
    project_joints(inverse, v + 1, lower);
    const Eigen::Vector3f* corners = corners_.data() + static_cast<std::size_t>(v) * (width_ + 1);
    const auto corner = [&](const Eigen::Vector2f& joint, int at, float w) -> Eigen::Vector2f {
      return std::isnan(joint.x()) ? project(corners[at], w) : joint;
    };
    for (int u = 0; u < width_; ++u) {
      const float w = inverse(u, v);
      const float z =
          depth_factors_[static_cast<std::size_t>(v) * width_ + u] * depth(u, v) + offset_.z();
      if (!(w > 0 && z > kNearest_m)) continue;
      const Eigen::Vector2f a = corner(upper[u], u, w), b = corner(upper[u + 1], u + 1, w);
      const Eigen::Vector2f c = corner(lower[u], width_ + 1 + u, w);
      const Eigen::Vector2f d = corner(lower[u + 1], width_ + 2 + u, w);
      const Eigen::Vector2f low = a.cwiseMin(b).cwiseMin(c.cwiseMin(d));
      const Eigen::Vector2f high = a.cwiseMax(b).cwiseMax(c.cwiseMax(d));
      if (!(a + b + c + d).allFinite()) continue;
      draw({low.x(), low.y(), high.x(), high.y()}, z, out);
    }
    std::swap(upper, lower);
  }
  return out;
}

}  // namespace sgs
