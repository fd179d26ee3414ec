// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sgs/eval/metrics.h"
#include "sgs/input/input.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {

/// Why a run over so few frames is none: in words, where less than a tenth of the colour images
/// that were asked for became frames. Frames that were dropped for time, or have no given pose, do
/// not count against it: ask for recordings that were played whole, with a tracker of its own.
std::optional<std::string> too_few_frames(const std::vector<slam::FrameRecord>& frames,
                                          const InputSpec& spec, const dataset::SequenceInfo& info);

/// What the finished path lets doubt about the recording: a speed that no hand has, or another
/// length than the truth's, mean another unit of depth or of time.
std::vector<std::string> doubts_about_units(const Run& run, const eval::Metrics& scores);

}  // namespace sgs::run
