// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sgs/runfolder/run.h"

namespace sgs::run {

/// A run of frames that are gone (a camera, a stream) as one of the recording that was made of them
/// on the way: frames are found there by their times, those that were not recorded are left out.
/// Fails where the recording cannot be opened, and where it has none of the run's frames.
Result<Run> run_of_recording(Run run, const std::filesystem::path& recording);

/// The same with the recording that the run's folder names; the run itself where its frames can be
/// had from its input, or nothing is named.
Result<Run> with_its_recording(Run run, const std::filesystem::path& folder);

}  // namespace sgs::run
