// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "helper_program.h"
#include "sgs/core/error.h"

namespace sgs::app {

/// How to make a mesh.
struct MeshOptions {
  double voxel_m = 0.015;
  bool measured = false;  ///< fuse the camera's depth instead of the map's
  bool upright = false;   ///< in the world turned upright
  int threads = 2;
};
/// The program that links OpenVDB, with what to do without it.
Result<HelperProgram> start_mesh_program(const std::string& purpose, const std::string& to_fit,
                                         const std::vector<std::string>& arguments);

/// Coloured mesh of the depth seen from the keyframes of a run, as PLY. The program sgs-mesh makes
/// it, which may not be installed: the error says so.
Status export_mesh(const std::string& run, const MeshOptions& options,
                   const std::filesystem::path& path);

}  // namespace sgs::app
