// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>

#include "sgs/core/error.h"
#include "sgs/map/gaussian.h"
#include "sgs/map/harmonics.h"

namespace sgs::io {

/// Turns our axes (x right, y down, z forward, as a camera stands) to those of glTF (y up).
Eigen::Matrix3d gltf_from_camera_axes();
/// Turns a world whose z points up to the axes of glTF: y up, and what was x looks along z, as the
/// front of things does there.
Eigen::Matrix3d gltf_from_upright_axes();

/// Writes binary glTF 2.0 with the extension KHR_gaussian_splatting (kernel `ellipse`, colours as
/// displayed): one primitive of points, every attribute as floats, harmonics by degree. Readers
/// that do not know the extension see coloured points (COLOR_0). The map must be in glTF's axes
/// already. No Gaussians, values that are not finite and more than the 4 GB that the container
/// holds are errors, and nothing is written.
Status save_glb(const std::filesystem::path& path, std::span<const map::Gaussian> splats,
                const map::Harmonics& harmonics = {});

}  // namespace sgs::io
