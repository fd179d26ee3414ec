// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sgs/runfolder/run.h"
#include "sgs/slam/session.h"
#include "sgs/tracker/known_view.h"

namespace sgs::run {

/// Writes the map that others can come back to (mapfile/map_file.h): the Gaussians, births and
/// views of a finished session, these at poses that agree with each other. `run` is what became of
/// it.
Status save_lasting_map(const std::filesystem::path& path, const slam::Session& session,
                        const Run& run, int threads);

/// Gives a session that has not begun the map of InputSpec::map. Depths are corrected as that map's
/// were where they come from the same camera and nothing else corrects them (`calibrated`).
Status localise(slam::Session& session, const std::filesystem::path& map,
                const PinholeCamera& camera, bool calibrated);

/// What a session that was given a map and never found itself there came to, in one sentence.
std::string not_found_sentence(const tracker::PlaceSearch& search, const std::string& map);

}  // namespace sgs::run
