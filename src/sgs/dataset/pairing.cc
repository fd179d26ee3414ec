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

namespace {

using Numbered = std::map<long, fs::path>;

long first_of(const Numbered& files) { return files.begin()->first; }
long last_of(const Numbered& files) { return files.rbegin()->first; }

/// Whether nearly every number from the first to the last is there.
bool without_gaps(const Numbered& files) {
  constexpr double kFewMissing = 0.05;
  const auto count = static_cast<double>(files.size());
  const double numbers =
      static_cast<double>(last_of(files)) - static_cast<double>(first_of(files)) + 1;
  return files.size() > 1 && numbers - count <= kFewMissing * count;
}

enum class Counters { kShared, kDoubtful, kOwn };

/// A shared counter skips what one stream lost; counters of their own begin and end elsewhere.
Counters counters_of(const Numbered& color, const Numbered& depth) {
  if (color.empty() || depth.empty()) return Counters::kShared;
  if (!without_gaps(color) || !without_gaps(depth)) return Counters::kShared;
  const bool color_earlier = first_of(color) < first_of(depth) && last_of(color) < last_of(depth);
  const bool depth_earlier = first_of(depth) < first_of(color) && last_of(depth) < last_of(color);
  if (!color_earlier && !depth_earlier) return Counters::kShared;
  return color.size() == depth.size() ? Counters::kOwn : Counters::kDoubtful;
}

void warn_of_counters(const Numbered& color, const Numbered& depth, Counters counters,
                      FrameList& out) {
  const std::string both =
      fmt::format("{}: colour is numbered {} to {}, depth {} to {}", out.folder.string(),
                  first_of(color), last_of(color), first_of(depth), last_of(depth));
  constexpr const char* kToml =
      "an sgs.toml with sequence.color, sequence.depth and match = \"{}\" says otherwise";
  if (counters == Counters::kOwn) {
    out.warnings.push_back(
        fmt::format("{}, equally many: each seems to have a counter of its own, so they are paired "
                    "in their order, not by number; {}",
                    both, fmt::format(fmt::runtime(kToml), "stem")));
  } else {
    out.warnings.push_back(
        fmt::format("{}: if each has a counter of its own, equal numbers are not equal times; they "
                    "are paired by number; {}",
                    both, fmt::format(fmt::runtime(kToml), "order")));
  }
}

}  // namespace

void pair_by_number(const Numbered& color, const Numbered& depth, double fps, FrameList& out) {
  const auto add = [&](long number, const fs::path& c, const fs::path& d) {
    out.frames.push_back(
        {static_cast<double>(number) / fps, c, d, out.folder.string(), out.folder.string()});
  };
  const Counters counters = counters_of(color, depth);
  if (counters != Counters::kShared) warn_of_counters(color, depth, counters, out);
  if (counters == Counters::kOwn) {
    auto partner = depth.begin();
    for (const auto& [number, file] : color) add(number, file, (partner++)->second);
    out.paired = "in order";
  } else {
    for (const auto& [number, file] : color) {
      if (const auto partner = depth.find(number); partner != depth.end()) {
        add(number, file, partner->second);
      }
    }
    out.paired = "of equal number";
  }
  out.color_without_depth = color.size() - out.frames.size();
  out.depth_without_color = depth.size() - out.frames.size();
  out.times_source = fmt::format("the numbers of the files, {:g} a second", fps);
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
  out.times_source = "the names of the files";
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
              fmt::format("needed: {}; or an sgs.toml that says how they belong together "
                          "(sequence.color, sequence.depth, match = \"order\" or \"stem\")",
                          needed));
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
