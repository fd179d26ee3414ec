// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "room_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

namespace sgs::benchmarks {
namespace {

/// Axis-aligned rectangle: coordinate `axis` equals `offset`; u and v span the other two axes.
struct Wall {
  int axis;
  double offset, u0, u1, v0, v1;
  int u_axis() const { return axis == 0 ? 1 : 0; }
  int v_axis() const { return axis == 2 ? 1 : 2; }
  double area() const { return (u1 - u0) * (v1 - v0); }
  Eigen::Vector3d at(double u, double v) const {
    Eigen::Vector3d p;
    p[axis] = offset;
    p[u_axis()] = u;
    p[v_axis()] = v;
    return p;
  }
};

std::vector<Wall> room_walls() {
  // The room, a table, a wardrobe, a sideboard, a stool, a box on the table.
  constexpr std::array<std::array<double, 6>, 6> kBoxes = {{{0, 0, 0, 6, 4.5, 2.8},
                                                            {3.5, 2.6, 0, 5.0, 3.6, 0.75},
                                                            {1.5, 3.9, 0, 2.3, 4.5, 2.0},
                                                            {5.2, 0.3, 0, 6, 1.6, 1.1},
                                                            {2.4, 1.2, 0, 2.9, 1.7, 0.5},
                                                            {3.8, 2.9, 0.75, 4.1, 3.2, 1.15}}};
  std::vector<Wall> walls;
  for (const auto& b : kBoxes) {
    for (const double x : {b[0], b[3]}) walls.push_back({0, x, b[1], b[4], b[2], b[5]});
    for (const double y : {b[1], b[4]}) walls.push_back({1, y, b[0], b[3], b[2], b[5]});
    for (const double z : {b[2], b[5]}) walls.push_back({2, z, b[0], b[3], b[1], b[4]});
  }
  return walls;
}

class Random {
 public:
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double normal() {
    return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937_64 engine_{42};
};

double texture(double u, double v, int wall, int channel) {
  return 0.5 + 0.25 * std::sin(9 * u + channel + wall) * std::cos(7 * v - 2 * channel) +
         0.2 * std::sin(31 * u + 17 * v + channel * wall);
}

map::Gaussian gaussian_on(const Wall& wall, int index, double u, double v, double sigma_m,
                          Random& random) {
  map::Gaussian g{};
  const Eigen::Vector3d p = wall.at(u, v);
  for (int i = 0; i < 3; ++i) {
    g.mean[i] = static_cast<float>(p[i] + 0.003 * random.normal());
    const double flat = i == 2 ? std::log(0.2) + 0.3 * random.normal() : 0.35 * random.normal();
    g.log_scale[i] = static_cast<float>(std::log(sigma_m) + flat);
    g.rgb[i] = static_cast<float>(texture(u, v, index, i));
  }
  const Eigen::Vector3d normal = Eigen::Vector3d::Unit(wall.axis);
  const Eigen::Quaterniond q =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal) *
      Eigen::AngleAxisd(2 * std::numbers::pi * random.uniform(), Eigen::Vector3d::UnitZ());
  const std::array<double, 4> wxyz = {q.w(), q.x(), q.y(), q.z()};
  for (std::size_t i = 0; i < 4; ++i) {
    g.rotation[i] = static_cast<float>(wxyz[i] + 0.05 * random.normal());
  }
  g.opacity_logit = static_cast<float>(1 + 1.2 * random.normal());
  return g;
}

struct Hit {
  int wall = 0;
  double distance = 0, cosine = 0;
  double u = 0, v = 0;
};

/// Nearest wall along a ray; `distance` in units of the direction's length.
Hit cast(const std::vector<Wall>& walls, const Eigen::Vector3d& origin,
         const Eigen::Vector3d& direction) {
  Hit best;
  best.distance = 1e9;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Wall& w = walls[i];
    if (std::abs(direction[w.axis]) < 1e-9) continue;
    const double t = (w.offset - origin[w.axis]) / direction[w.axis];
    if (t < 0.05 || t >= best.distance) continue;
    const double u = origin[w.u_axis()] + t * direction[w.u_axis()];
    const double v = origin[w.v_axis()] + t * direction[w.v_axis()];
    if (u < w.u0 || u > w.u1 || v < w.v0 || v > w.v1) continue;
    best = {static_cast<int>(i), t, std::abs(direction[w.axis]) / direction.norm(), u, v};
  }
  return best;
}

}  // namespace

std::vector<map::Gaussian> make_room(int gaussians, double sigma) {
  const auto walls = room_walls();
  Random random;
  double area = 0;
  for (const Wall& w : walls) area += w.area();
  const double spacing = std::sqrt(area / gaussians);
  std::vector<map::Gaussian> out;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Wall& w = walls[i];
    const int left = gaussians - static_cast<int>(out.size());
    const int share = static_cast<int>(gaussians * w.area() / area + 0.5);
    const int n = i + 1 == walls.size() ? left : std::min(share, left);
    const int columns = std::max(1, static_cast<int>(std::sqrt(n * (w.u1 - w.u0) / (w.v1 - w.v0))));
    const int rows = (n + columns - 1) / columns;
    for (int k = 0; k < n; ++k) {
      const double u = w.u0 + (w.u1 - w.u0) * (k % columns + random.uniform()) / columns;
      const double v = w.v0 + (w.v1 - w.v0) * (k / columns + random.uniform()) / rows;
      out.push_back(gaussian_on(w, static_cast<int>(i), u, v, sigma * spacing, random));
    }
  }
  return out;
}

std::vector<map::Gaussian> make_view_filling(int gaussians, double sigma) {
  const auto walls = room_walls();
  const PinholeCamera camera = room_camera(640);
  const SE3 pose = room_pose();
  Random random;
  const double step = std::sqrt(640.0 * 480.0 / gaussians);
  const int columns = static_cast<int>(std::ceil(640 / step));
  const int rows = (gaussians + columns - 1) / columns;
  std::vector<map::Gaussian> out;
  for (int i = 0; i < gaussians; ++i) {
    const double x = (i % columns + random.uniform()) * 640 / columns;
    const double y = (i / columns + random.uniform()) * 480 / rows;
    const Eigen::Vector3d direction = pose.R * camera.back_project(x, y, 1);
    const Hit hit = cast(walls, pose.t, direction);
    const double spacing = hit.distance * step / camera.fx / std::sqrt(std::max(0.15, hit.cosine));
    out.push_back(gaussian_on(walls[static_cast<std::size_t>(hit.wall)], hit.wall, hit.u, hit.v,
                              sigma * spacing, random));
  }
  return out;
}

PinholeCamera room_camera(int width) {
  const int height = width * 3 / 4;
  const double f = 525.0 * width / 640;
  return {width, height, f, f, 0.5 * width - 0.5, 0.5 * height - 0.5};
}

SE3 room_pose() {
  const Eigen::Vector3d eye(0.7, 0.7, 1.5), at(4.5, 3.2, 1.0);
  const Eigen::Vector3d forward = (at - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R << right, forward.cross(right), forward;
  return {R, eye};
}

render::TrainingImage disturbed_view(render::Rasterizer& rasterizer,
                                     const std::vector<map::Gaussian>& gaussians,
                                     const PinholeCamera& camera, const SE3& pose) {
  render::Rendering seen;
  rasterizer.render(gaussians, camera, pose, seen);
  render::TrainingImage out{camera, Image<render::Rgbf>(camera.width, camera.height),
                            DepthImage(camera.width, camera.height)};
  Random random;
  const auto factor = [&] { return static_cast<float>(0.9 + 0.2 * random.uniform()); };
  for (std::size_t i = 0; i < out.color.size(); ++i) {
    const render::Rgbf& c = seen.color.data()[i];
    out.color.data()[i] = {c.r * factor(), c.g * factor(), c.b * factor()};
    out.depth.data()[i] = seen.depth_sum.data()[i] * factor();
  }
  return out;
}

}  // namespace sgs::benchmarks
