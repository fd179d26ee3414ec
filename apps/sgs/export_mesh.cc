// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "export_mesh.h"

#include <fmt/format.h>

namespace sgs::app {

Result<HelperProgram> start_mesh_program(const std::string& purpose, const std::string& to_fit,
                                         const std::vector<std::string>& arguments) {
  return HelperProgram::start(
      {.name = "sgs-mesh",
       .purpose = purpose,
       .to_install = "install the package sgs-mesh; for a build from source install "
                     "libopenvdb-dev, then configure and build again",
       .to_fit = to_fit},
      arguments);
}

Status export_mesh(const std::string& run, const MeshOptions& options,
                   const std::filesystem::path& path) {
  std::vector<std::string> arguments = {run,         path.string(),
                                        "--voxel",   fmt::format("{}", options.voxel_m),
                                        "--threads", fmt::format("{}", options.threads)};
  if (options.measured) arguments.emplace_back("--measured-depth");
  if (options.upright) arguments.emplace_back("--upright");
  SGS_ASSIGN_OR_RETURN(
      auto program,
      start_mesh_program("meshes", "is there enough memory? A larger --voxel needs less",
                         arguments));
  return program.finish();
}

}  // namespace sgs::app
