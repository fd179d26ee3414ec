// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/map/gaussian.h"
#include "sgs/map/harmonics.h"

namespace sgs::io {

/// Writes Niantic's SPZ, version 2 (github.com/nianticlabs/spz, README): a gzip stream of a 16-byte
/// header and, attribute by attribute, positions (24-bit fixed point), opacities, colours, scales
/// (8-bit logarithms in steps of 1/16) and rotations (x y z in 8 bits, w >= 0 implied; up to half
/// turns that leave the ellipsoid as it is), and the coefficients of `harmonics`, where there are
/// any, in steps of 1/128 within -1 to 1. Axes turn from those of our PLY (x right, y down, z
/// forward) to SPZ's (x right, y up, z back) and readers turn them back. Positions get as many
/// fractional bits, at most 16, as their range allows. Values that are not finite are an error and
/// nothing is written.
Status save_spz(const std::filesystem::path& path, std::span<const map::Gaussian> splats,
                const map::Harmonics& harmonics = {});

/// Reads version 2. Damaged and other files are errors that name the file.
Result<map::SplatMap> load_spz(const std::filesystem::path& path);

}  // namespace sgs::io
