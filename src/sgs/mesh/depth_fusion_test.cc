// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mesh/depth_fusion.h"

#include <gmock/gmock.h>

namespace sgs::mesh {
namespace {

const PinholeCamera kCamera{120, 90, 100, 100, 60, 45};

/// Depth of the plane z = 1.2 m of the world, blue on the left and red on the right.
void add_plane(DepthFusion& fusion, const SE3& T_world_camera, double plane_z = 1.2) {
  DepthImage depth(kCamera.width, kCamera.height);
  ColorImage color(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Eigen::Vector3d ray = T_world_camera.R * kCamera.back_project(u, v, 1);
      const double z = (plane_z - T_world_camera.t.z()) / ray.z();
      depth(u, v) = static_cast<float>(z);
      const Eigen::Vector3d p = T_world_camera.t + z * ray;
      color(u, v) = p.x() < 0 ? Rgb8{0, 0, 200} : Rgb8{200, 0, 0};
    }
  }
  fusion.add(kCamera, T_world_camera, depth, color);
}

SE3 turned(double about_y) {
  Vector6d xi;
  xi << 0, about_y, 0, 0.1, 0, 0;
  return SE3::exp(xi);
}

TEST(DepthFusion, PlaneSeenTwice) {
  DepthFusion fusion({});
  add_plane(fusion, SE3{});
  add_plane(fusion, turned(0.15));
  const TriangleMesh mesh = fusion.mesh();
  ASSERT_GT(mesh.triangles.size(), 500u);
  for (const io::ColoredPoint& vertex : mesh.vertices) {
    // Projective distances of slanted views shrink or grow, they do not move the zero.
    EXPECT_NEAR(vertex.position.z(), 1.2, 0.004);
    if (std::abs(vertex.position.x()) > 0.03) {
      EXPECT_EQ(vertex.color, vertex.position.x() < 0 ? (Rgb8{0, 0, 200}) : (Rgb8{200, 0, 0}));
    }
  }
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t k) { return mesh.vertices[t[k]].position; };
    const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0));
    EXPECT_LT(normal.z(), 0) << "triangles face the cameras";
  }
}

TEST(DepthFusion, WhatTooFewViewsSawIsLeftOut) {
  DepthFusion fusion({});
  add_plane(fusion, SE3{});
  EXPECT_TRUE(fusion.mesh().triangles.empty());
  DepthFusionConfig config;
  config.min_views = 1;
  DepthFusion one_is_enough(config);
  add_plane(one_is_enough, SE3{});
  EXPECT_FALSE(one_is_enough.mesh().triangles.empty());
}

TEST(DepthFusion, NothingFarAndNothingWithoutDepth) {
  DepthFusion fusion({});
  EXPECT_TRUE(fusion.mesh().vertices.empty());
  for (int i = 0; i < 2; ++i) {
    add_plane(fusion, SE3{}, 20);
    fusion.add(kCamera, SE3{}, DepthImage(kCamera.width, kCamera.height),
               ColorImage(kCamera.width, kCamera.height));
  }
  EXPECT_TRUE(fusion.mesh().vertices.empty());
}

}  // namespace
}  // namespace sgs::mesh
