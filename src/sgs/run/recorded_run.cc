// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/recorded_run.h"

#include <fmt/format.h>

#include <utility>

#include "sgs/dataset/feed_item.h"
#include "sgs/stream/address.h"

namespace sgs::run {
Result<Run> run_of_recording(Run run, const std::filesystem::path& recording) {
  constexpr double kSameTime_s = 2e-6;  // frames.csv keeps nine digits
  InputSpec spec;
  spec.input = recording.string();
  spec.max_width = 0;  // as it was recorded
  SGS_ASSIGN_OR_RETURN(const auto input, open_input(spec, 1));
  std::vector<slam::FrameRecord> found;
  auto record = run.frames.begin();
  std::int64_t frames = 0;
  while (const auto item = dataset::read_item(*input.source)) {
    ++frames;
    while (record != run.frames.end() && record->timestamp_s < item->timestamp_s - kSameTime_s) {
      ++record;
    }
    if (record == run.frames.end()) continue;
    if (record->timestamp_s > item->timestamp_s + kSameTime_s || record->bad) continue;
    found.push_back(std::move(*record++));
    found.back().index = item->index;
  }
  if (found.empty()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} has no frame of the run {}", recording.string(), run.name),
                "it is the recording of another run");
  }
  run.frames = std::move(found);
  run.frames_total = frames;
  // A calibration that was given is in what was recorded; what was learned on the way is not.
  if (!run.input.calibration.empty()) run.calibration.reset();
  run.input = std::move(spec);
  return run;
}

Result<Run> with_its_recording(Run run, const std::filesystem::path& folder) {
  if (!stream::is_stream(run.input.input) || run.state.recording.empty()) return run;
  const std::filesystem::path recording = folder / run.state.recording;  // which may be absolute
  std::error_code unreadable;
  if (!std::filesystem::exists(recording, unreadable)) {
    return fail(ErrorCode::kNotFound,
                fmt::format("the frames of the run in {} were kept in {}, which is not there",
                            folder.string(), recording.string()),
                "bring it back to that place; a map cannot be refined without its pictures");
  }
  return run_of_recording(std::move(run), recording);
}

}  // namespace sgs::run
