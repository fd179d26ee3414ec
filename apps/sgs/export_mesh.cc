// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "export_mesh.h"

#include <fmt/format.h>

#include "helper_program.h"

namespace sgs::app {

Status export_mesh(const std::string& run, const MeshOptions& options,
                   const std::filesystem::path& path) {
  std::vector<std::string> arguments = {run,         path.string(),
                                        "--voxel",   fmt::format("{}", options.voxel_m),
                                        "--threads", fmt::format("{}", options.threads)};
  if (options.measured) arguments.emplace_back("--measured-depth");
  if (options.upright) arguments.emplace_back("--upright");
  SGS_ASSIGN_OR_RETURN(
      auto program,
      HelperProgram::start(
          {.name = "sgs-mesh",
           .purpose = "meshes",
           .to_install = "install the package sgs-mesh; for a build from source install "
                         "libopenvdb-dev, then configure and build again",
           .to_fit = "is there enough memory? A larger --voxel needs less"},
          arguments));
  return program.finish();
}

}  // namespace sgs::app
