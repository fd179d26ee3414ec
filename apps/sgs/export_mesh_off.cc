// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "export_mesh.h"

namespace sgs::app {

Status export_mesh(const std::string&, std::span<const map::Gaussian>, const MeshOptions&,
                   const std::filesystem::path&) {
  return fail(ErrorCode::kUnsupported, "this build of sgs cannot make meshes",
              "install libopenvdb-dev, then configure and build again");
}

}  // namespace sgs::app
