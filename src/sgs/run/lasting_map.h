// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/alignment/known_view.h"
#include "sgs/mapfile/map_file.h"
#include "sgs/runfolder/run.h"
#include "sgs/slam/session.h"

namespace sgs::run {

/// Writes the map that others can come back to (mapfile/map_file.h): the Gaussians, births and
/// views of a finished session, these at poses that agree with each other, and of those whose map
/// it went on with (`earlier`). `run` is what became of it.
Status save_lasting_map(const std::filesystem::path& path, const slam::Session& session,
                        const Run& run, std::vector<mapfile::MapSession> earlier, int threads);

/// Gives a session that has not begun the map of InputSpec::map, to find itself there or to go on
/// with it (InputSpec::extends_map). Depths are corrected as those of the map's newest session were
/// where they come from the same camera and nothing else corrects them (`calibrated`). Returns the
/// sessions of the map. The file is read here and never again.
Result<std::vector<mapfile::MapSession>> give_map(slam::Session& session, const InputSpec& spec,
                                                  const PinholeCamera& camera, bool calibrated);

/// What a session that was given a map and never found itself there came to, in one sentence.
std::string not_found_sentence(const tracker::PlaceSearch& search, const std::string& map);

}  // namespace sgs::run
