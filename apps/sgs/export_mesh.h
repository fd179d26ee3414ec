// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "sgs/core/error.h"
#include "sgs/map/gaussian.h"

namespace sgs::app {

/// How to make a mesh.
struct MeshOptions {
  double voxel_m = 0.015;
  bool measured = false;  ///< fuse the camera's depth instead of the map's
  int threads = 2;
};
/// Coloured mesh of the depth seen from the keyframes, as PLY.
Status export_mesh(const std::string& run, std::span<const map::Gaussian> gaussians,
                   const MeshOptions& options, const std::filesystem::path& path);

}  // namespace sgs::app
