// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>

#include "sgs/core/error.h"
#include "sgs/map/gaussian.h"
#include "sgs/map/harmonics.h"

namespace sgs::io {

/// Whether Gaussians can be written at all: everything finite, no zero rotation. The error names
/// `path` and the first bad Gaussian. `harmonics` are theirs, or none.
Status check_splats(const std::filesystem::path& path, std::span<const map::Gaussian> splats,
                    const map::Harmonics& harmonics = {});

/// The rotation as a unit quaternion w x y z.
std::array<double, 4> unit_rotation(const map::Gaussian& gaussian);
/// Inverse of map::opacity(), clamped to +-16 where it would be infinite.
float opacity_logit(double opacity);

/// Colour in splat files is (rgb - 0.5) / kSh0: SH basis function of degree 0, 1 / (2 sqrt(pi)).
inline constexpr double kSh0 = 0.28209479177387814;

}  // namespace sgs::io
