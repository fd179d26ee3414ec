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

/// Versions of SPZ that are written.
enum class SpzVersion {
  kGzip = 2,  ///< one gzip stream; for readers from before 2026
  kZstd = 4,  ///< a stream of Zstandard for each attribute, rotations in 32 bits
};

/// Writes Niantic's SPZ (github.com/nianticlabs/spz, README). Attribute by attribute: positions
/// (24-bit fixed point), opacities, colours, scales (8-bit logarithms in steps of 1/16) and
/// rotations, and the coefficients of `harmonics`, where there are any, in steps of 1/128 within -1
/// to 1. Rotations of version 4 have three components of 10 bits; those of version 2 have x y z in
/// 8 bits and w >= 0 implied, up to half turns that leave the ellipsoid as it is. Axes turn from
/// those of our PLY (x right, y down, z forward) to SPZ's (x right, y up, z back) and readers turn
/// them back. Positions get as many fractional bits, at most 16, as their range allows. Values that
/// are not finite are an error and nothing is written.
Status save_spz(const std::filesystem::path& path, std::span<const map::Gaussian> splats,
                const map::Harmonics& harmonics = {}, SpzVersion version = SpzVersion::kZstd);

/// Reads versions 2, 3 and 4. Damaged and other files are errors that name the file.
Result<map::SplatMap> load_spz(const std::filesystem::path& path);

}  // namespace sgs::io
