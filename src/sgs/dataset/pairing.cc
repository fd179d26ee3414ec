// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/pairing.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "sgs/dataset/association.h"
#include "sgs/dataset/depth_stamps.h"

namespace sgs::dataset {
namespace fs = std::filesystem;

TimedFiles files_by_time(
    const std::vector<fs::path>& files,
    const std::function<std::optional<double>(const std::string& stem)>& time_of) {
  std::map<double, fs::path> timed;
  for (const fs::path& file : files) {
    const auto time_s = time_of(file.stem().string());
    if (time_s && std::isfinite(*time_s)) timed.emplace(*time_s, file);
  }
  TimedFiles out;
  for (auto& [time_s, file] : timed) {
    out.times_s.push_back(time_s);
    out.files.push_back(std::move(file));
  }
  return out;
}

void add_confidence(const fs::path& folder, FrameList& list) {
  for (FrameEntry& frame : list.frames) {
    fs::path confidence = folder / frame.depth.filename();
    if (fs::exists(confidence)) frame.confidence = std::move(confidence);
  }
}

std::optional<TimedFiles> files_with_microseconds(const std::vector<fs::path>& files) {
  bool all = true;
  auto timed = files_by_time(files, [&](const std::string& stem) -> std::optional<double> {
    const auto dash = stem.rfind('-');
    long long microseconds = 0;
    if (dash != std::string::npos) {
      const char *first = stem.data() + dash + 1, *last = stem.data() + stem.size();
      const auto parsed = std::from_chars(first, last, microseconds);
      if (parsed.ec == std::errc{} && parsed.ptr == last) {
        return static_cast<double>(microseconds) / 1e6;
      }
    }
    all = false;
    return std::nullopt;
  });
  return all ? std::optional(std::move(timed)) : std::nullopt;
}

void pair_by_number(const std::map<long, fs::path>& color, const std::map<long, fs::path>& depth,
                    double fps, FrameList& out) {
  for (const auto& [number, file] : color) {
    const auto partner = depth.find(number);
    if (partner == depth.end()) continue;
    out.frames.push_back({static_cast<double>(number) / fps, file, partner->second,
                          out.folder.string(), out.folder.string()});
  }
  out.color_without_depth = color.size() - out.frames.size();
  out.depth_without_color = depth.size() - out.frames.size();
}

void pair_by_time(const TimedFiles& color, const TimedFiles& depth, double max_difference_s,
                  FrameList& out) {
  for (const auto& [i, j] : associate(color.times_s, depth.times_s, max_difference_s)) {
    FrameEntry& frame =
        out.frames.emplace_back(FrameEntry{color.times_s[i], color.files[i], depth.files[j],
                                           out.folder.string(), out.folder.string()});
    frame.depth_delay_s = depth.times_s[j] - color.times_s[i];
  }
  drop_implausible_delays(out);
  out.color_without_depth = color.files.size() - out.frames.size();
  out.depth_without_color = depth.files.size() - out.frames.size();
}

void drop_implausible_delays(FrameList& list) {
  if (list.frames.empty()) return;
  std::vector<double> delays_s, stamps_s;
  for (const FrameEntry& frame : list.frames) {
    delays_s.push_back(frame.depth_delay_s);
    stamps_s.push_back(frame.timestamp_s + frame.depth_delay_s);
  }
  if (auto why = implausible_delays(delays_s, stamps_s)) {
    list.warnings.push_back(fmt::format("{}: {}", list.folder.string(), *why));
    for (FrameEntry& frame : list.frames) frame.depth_delay_s = 0;
  }
}

Status require_frames(const FrameList& list, const char* needed) {
  if (!list.frames.empty()) return {};
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{}: {} layout, but no colour image has a depth image ({} and {} alone)",
                          list.folder.string(), list.layout, list.color_without_depth,
                          list.depth_without_color),
              fmt::format("needed: {}", needed));
}

Status add_frame_poses(
    FrameList& list, const std::function<Result<std::optional<SE3>>(std::size_t frame)>& pose_of) {
  std::size_t without = 0;
  for (std::size_t i = 0; i < list.frames.size(); ++i) {
    SGS_ASSIGN_OR_RETURN(const auto pose, pose_of(i));
    if (pose) {
      list.truth.push_back({list.frames[i].timestamp_s, *pose});
    } else {
      ++without;
    }
  }
  if (without > 0) {
    list.warnings.push_back(fmt::format("{}: {} of {} frames have no usable pose",
                                        list.folder.string(), without, list.frames.size()));
  }
  return {};
}

}  // namespace sgs::dataset
