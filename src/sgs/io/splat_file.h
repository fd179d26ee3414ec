// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/map/gaussian.h"

namespace sgs::io {

/// One Gaussian in a .splat file (the format of antimatter15/splat): 32 bytes, little endian.
/// Position (3 float), standard deviations (3 float, metres), r g b opacity (4 bytes, 255 = 1),
/// rotation w x y z (4 bytes, 128 + 128 q).
inline constexpr std::size_t kSplatRecordBytes = 32;

/// The records of Gaussians that have passed check_splats().
std::string splat_records(std::span<const map::Gaussian> splats);
/// The inverse, as precise as the bytes are; the size must be a multiple of kSplatRecordBytes.
std::vector<map::Gaussian> splats_from_records(std::string_view records);

/// Harmonics beside records, for our own pages: a byte per number, 128 + 128 times it within -1 to
/// 1, each Gaussian's padded to a multiple of 16 bytes with 128. Empty without harmonics.
std::string harmonic_records(const map::Harmonics& harmonics);

/// Writes a .splat file. Values that are not finite are an error and nothing is written.
Status save_splat_file(const std::filesystem::path& path, std::span<const map::Gaussian> splats);

}  // namespace sgs::io
