// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sgs/mapfile/map_file.h"
#include "sgs/upright/upright.h"

namespace sgs::run {

/// The Gaussians of a run folder, of a map file (mapfile::MapFile), or of a splat PLY.
Result<map::SplatMap> load_any_map(const std::filesystem::path& path);

/// Which way is up in a map file, by the level surfaces that its views measured and by how its
/// cameras were held: what an accelerometer has said is kept with the run, not with the map.
Result<Upright> upright_of_map(const mapfile::MapFile& map);

/// Turns the world of a run folder or of a map file: z up.
Result<SE3> load_any_upright(const std::filesystem::path& path);

}  // namespace sgs::run
