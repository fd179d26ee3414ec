// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mesh/depth_fusion.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace sgs::mesh {
namespace {

openvdb::Coord nearest_voxel(const Eigen::Vector3d& p_world, double voxel_m) {
  const auto index = [&](int k) { return static_cast<int>(std::lround(p_world[k] / voxel_m)); };
  return {index(0), index(1), index(2)};
}

std::uint8_t byte(float v) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0f, 255.0f)));
}

}  // namespace

struct DepthFusion::Grids {
  openvdb::FloatGrid::Ptr distance;  // mean signed distance, positive in front of the surface
  openvdb::FloatGrid::Ptr views;     // number of views behind the mean
  openvdb::Vec3SGrid::Ptr color;     // mean colour, 0..255
};

DepthFusion::DepthFusion(const DepthFusionConfig& config)
    : config_(config), grids_(std::make_unique<Grids>()) {
  SGS_CHECK(config.voxel_m > 0 && config.truncation_voxels >= 2, "the band needs a few voxels");
  openvdb::initialize();
  const auto truncation_m = static_cast<float>(config.truncation_voxels * config.voxel_m);
  grids_->distance = openvdb::FloatGrid::create(truncation_m);
  grids_->views = openvdb::FloatGrid::create(0.0f);
  grids_->color = openvdb::Vec3SGrid::create(openvdb::Vec3f(0));
  grids_->distance->setTransform(openvdb::math::Transform::createLinearTransform(config.voxel_m));
}

DepthFusion::~DepthFusion() = default;

void DepthFusion::add(const PinholeCamera& camera, const SE3& T_world_camera,
                      const DepthImage& depth, const ColorImage& color) {
  SGS_CHECK(depth.width() == camera.width && depth.height() == camera.height &&
                color.width() == camera.width && color.height() == camera.height,
            "depth and colour must have the camera's size");
  const double truncation_m = config_.truncation_voxels * config_.voxel_m;

  // Voxels near a measured surface.
  auto touched = openvdb::MaskGrid::create();
  auto touch = touched->getAccessor();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double z = depth(u, v);
      if (z <= 0 || z > config_.max_depth_m) continue;
      // Where several pixels share a voxel one of them is enough.
      const int stride = std::clamp(static_cast<int>(0.7 * config_.voxel_m * camera.fx / z), 1, 16);
      if (u % stride != 0 || v % stride != 0) continue;
      for (double d = z - truncation_m; d <= z + truncation_m; d += 0.7 * config_.voxel_m) {
        if (d <= 0) continue;
        touch.setValueOn(
            nearest_voxel(T_world_camera * camera.back_project(u, v, d), config_.voxel_m));
      }
    }
  }

  const SE3 T_camera_world = T_world_camera.inverse();
  auto distance = grids_->distance->getAccessor();
  auto views = grids_->views->getAccessor();
  auto colors = grids_->color->getAccessor();
  for (auto it = touched->cbeginValueOn(); it; ++it) {
    const openvdb::Coord ijk = it.getCoord();
    const Eigen::Vector3d p =
        T_camera_world * (config_.voxel_m * Eigen::Vector3d(ijk.x(), ijk.y(), ijk.z()));
    if (p.z() <= 0) continue;
    const Eigen::Vector2d uv = camera.project(p);
    const auto u = static_cast<int>(std::lround(uv.x())), v = static_cast<int>(std::lround(uv.y()));
    if (!depth.contains(u, v) || depth(u, v) <= 0) continue;
    const double signed_distance = depth(u, v) - p.z();
    if (std::abs(signed_distance) > truncation_m) continue;
    const float n = views.getValue(ijk), share = 1 / (n + 1);
    const float before = n > 0 ? distance.getValue(ijk) : 0.0f;
    distance.setValueOn(ijk, before + share * (static_cast<float>(signed_distance) - before));
    const Rgb8 c = color(u, v);
    const openvdb::Vec3f seen(c.r, c.g, c.b), mean = colors.getValue(ijk);
    colors.setValueOn(ijk, mean + share * (seen - mean));
    views.setValueOn(ijk, n + 1);
  }
}

TriangleMesh DepthFusion::mesh() const {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grids_->distance, points, triangles, quads, 0.0, 0.0);
  const auto views = grids_->views->getConstAccessor();
  const auto colors = grids_->color->getConstAccessor();

  // A point lies within a cell of eight voxels. Where one of them was not seen, the sign change may
  // be that to the background behind the band and not a surface.
  const auto vertex_at = [&](const openvdb::Vec3s& p) -> std::optional<io::ColoredPoint> {
    const openvdb::Vec3d index = grids_->distance->worldToIndex(openvdb::Vec3d(p));
    const openvdb::Coord cell = openvdb::Coord::floor(index);
    for (int corner = 0; corner < 8; ++corner) {
      const auto ijk = cell.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2);
      if (views.getValue(ijk) < static_cast<float>(config_.min_views)) return std::nullopt;
    }
    const openvdb::Vec3f c = colors.getValue(openvdb::Coord::round(index));
    return io::ColoredPoint{{p.x(), p.y(), p.z()}, {byte(c.x()), byte(c.y()), byte(c.z())}};
  };
  TriangleMesh mesh;
  constexpr std::uint32_t kDropped = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> index_of(points.size(), kDropped);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (const auto vertex = vertex_at(points[i])) {
      index_of[i] = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back(*vertex);
    }
  }
  const auto add_triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const std::array<std::uint32_t, 3> t = {index_of[a], index_of[b], index_of[c]};
    if (std::find(t.begin(), t.end(), kDropped) == t.end()) mesh.triangles.push_back(t);
  };
  for (const auto& t : triangles) add_triangle(t[0], t[1], t[2]);
  for (const auto& q : quads) {
    add_triangle(q[0], q[1], q[2]);
    add_triangle(q[0], q[2], q[3]);
  }
  return mesh;
}

}  // namespace sgs::mesh
