// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/geometry/se3.h"
#include "sgs/io/ply.h"

namespace sgs::mesh {

struct DepthFusionConfig {
  double voxel_m = 0.015;
  double truncation_voxels = 4;  ///< half the width of the band around a surface
  double max_depth_m = 8;        ///< farther measurements are left out
  int min_views = 2;             ///< surface seen in fewer views is left out
};

/// Coloured triangles, counter-clockwise as seen from outside (from the cameras).
struct TriangleMesh {
  std::vector<io::ColoredPoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Fuses depth images into a truncated signed distance field in sparse OpenVDB grids (Curless and
/// Levoy, SIGGRAPH 1996, with projective distances averaged over views) and extracts its zero set
/// by OpenVDB's adaptive dual contouring. Not thread-safe.
class DepthFusion {
 public:
  explicit DepthFusion(const DepthFusionConfig& config);
  ~DepthFusion();

  /// One view; depth and colour have the camera's size.
  void add(const PinholeCamera& camera, const SE3& T_world_camera, const DepthImage& depth,
           const ColorImage& color);
  TriangleMesh mesh() const;

 private:
  struct Grids;
  DepthFusionConfig config_;
  std::unique_ptr<Grids> grids_;
};

}  // namespace sgs::mesh
