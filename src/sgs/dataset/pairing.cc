// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/pairing.h"

#include <algorithm>
#include <charconv>

#include "sgs/dataset/association.h"

namespace sgs::dataset {
namespace fs = std::filesystem;

std::optional<TimedFiles> files_with_microseconds(const std::vector<fs::path>& files) {
  std::vector<std::pair<double, fs::path>> timed;
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    const auto dash = stem.rfind('-');
    if (dash == std::string::npos) return std::nullopt;
    long long microseconds = 0;
    const char *first = stem.data() + dash + 1, *last = stem.data() + stem.size();
    const auto parsed = std::from_chars(first, last, microseconds);
    if (parsed.ec != std::errc{} || parsed.ptr != last) return std::nullopt;
    timed.emplace_back(static_cast<double>(microseconds) / 1e6, file);
  }
  std::stable_sort(timed.begin(), timed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  timed.erase(std::unique(timed.begin(), timed.end(),
                          [](const auto& a, const auto& b) { return a.first == b.first; }),
              timed.end());
  TimedFiles out;
  for (auto& [time_s, file] : timed) {
    out.times_s.push_back(time_s);
    out.files.push_back(std::move(file));
  }
  return out;
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
    out.frames.push_back({color.times_s[i], color.files[i], depth.files[j], out.folder.string(),
                          out.folder.string()});
  }
  out.color_without_depth = color.files.size() - out.frames.size();
  out.depth_without_color = depth.files.size() - out.frames.size();
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
