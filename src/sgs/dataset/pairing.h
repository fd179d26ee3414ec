// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "sgs/dataset/frame_list.h"

namespace sgs::dataset {

/// Files with the times they were taken at.
struct TimedFiles {
  std::vector<double> times_s;  ///< rising
  std::vector<std::filesystem::path> files;
};

/// Files in order of time, as `time_of` tells it from a name without its extension; of equal times
/// the first file counts. Those without a time are left out.
TimedFiles files_by_time(
    const std::vector<std::filesystem::path>& files,
    const std::function<std::optional<double>(const std::string& stem)>& time_of);

/// Sets the confidence of frames that have an image of it in `folder`, under the name of their
/// depth.
void add_confidence(const std::filesystem::path& folder, FrameList& list);

/// Files named FRAME-MICROSECONDS (SUN3D, Redwood); empty where any name has another form.
std::optional<TimedFiles> files_with_microseconds(const std::vector<std::filesystem::path>& files);

/// Makes frames of colour and depth files with equal numbers, frame n at n / `fps` seconds. Where
/// both are counted without gaps, equally many but from different numbers on, each has a counter of
/// its own, and they are paired in their order, with a warning.
void pair_by_number(const std::map<long, std::filesystem::path>& color,
                    const std::map<long, std::filesystem::path>& depth, double fps, FrameList& out);

/// Makes frames of colour and depth files that are near in time (association.h); colour gives the
/// time.
void pair_by_time(const TimedFiles& color, const TimedFiles& depth, double max_difference_s,
                  FrameList& out);

/// Takes all depth as of its colour's time, with a warning, where its stamps cannot be of the same
/// clock: more than 50 ms off in the median, which no camera that pairs images is, or the same for
/// all frames.
void drop_implausible_delays(FrameList& list);

/// An error that names the folder and what is needed where a list has no frames.
Status require_frames(const FrameList& list, const char* needed);

/// Takes the poses that `pose_of` finds for the list's frames as its ground truth. Frames without
/// one (an empty value) are counted in a warning.
Status add_frame_poses(FrameList& list,
                       const std::function<Result<std::optional<SE3>>(std::size_t frame)>& pose_of);

}  // namespace sgs::dataset
