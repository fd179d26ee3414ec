// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/input_doubts.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sgs::run {
namespace {

/// The reason that most bad frames have; numbers and names in them differ, so by its beginning.
std::string usual_reason(const std::vector<slam::FrameRecord>& frames) {
  constexpr std::size_t kBeginning = 24;
  std::map<std::string, std::pair<std::size_t, std::string>> reasons;
  for (const slam::FrameRecord& frame : frames) {
    if (!frame.bad) continue;
    auto& [count, first] = reasons[frame.bad_reason.substr(0, kBeginning)];
    if (count++ == 0) first = frame.bad_reason;
  }
  const auto most = std::max_element(
      reasons.begin(), reasons.end(),
      [](const auto& a, const auto& b) { return a.second.first < b.second.first; });
  return most == reasons.end() ? "the others have no depth image; the warnings say why"
                               : most->second.second;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<std::string> too_few_frames(const std::vector<slam::FrameRecord>& frames,
                                          const InputSpec& spec,
                                          const dataset::SequenceInfo& info) {
  constexpr std::int64_t kLeastShare = 10;  // one in so many
  const auto range = parse_frame_range(spec.frames);
  if (!range) return std::nullopt;
  const std::int64_t asked =
      std::min(info.color_images, range->last) - std::min(info.color_images, range->first);
  const auto offered = std::max(asked, static_cast<std::int64_t>(frames.size()));
  const auto used = static_cast<std::int64_t>(std::count_if(
      frames.begin(), frames.end(), [](const slam::FrameRecord& f) { return !f.bad; }));
  if (kLeastShare * used >= offered) return std::nullopt;
  return fmt::format("only {} of {} colour images became frames: {}", used, offered,
                     usual_reason(frames));
}

std::vector<std::string> doubts_about_units(const Run& run, const eval::Metrics& scores) {
  constexpr double kFast_m_s = 3, kSlow_m_s = 5e-4, kSomeWay_m = 0.1, kScale_percent = 15;
  std::vector<std::string> doubts;
  std::vector<double> speeds;
  double way_m = 0;
  const auto& poses = run.trajectory.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double step_s = poses[i].timestamp_s - poses[i - 1].timestamp_s;
    const double step_m = (poses[i].T_world_camera.t - poses[i - 1].T_world_camera.t).norm();
    way_m += step_m;
    if (step_s > 0) speeds.push_back(step_m / step_s);
  }
  constexpr std::size_t kEnough = 10;
  if (speeds.size() >= kEnough && way_m > kSomeWay_m) {
    const double speed = median_of(speeds);
    if (speed > kFast_m_s || speed < kSlow_m_s) {
      doubts.push_back(fmt::format(
          "the camera moves at {:.2g} m/s, which is too {} for a hand: is the unit of depth right "
          "(--depth-scale), and that of the times?",
          speed, speed > kFast_m_s ? "fast" : "slow"));
    }
  }
  const double scale = scores.scale_error_percent.value_or(0);
  if (std::abs(scale) > kScale_percent && way_m > kSomeWay_m) {
    doubts.push_back(
        fmt::format("the path is {:.0f} % {} than the ground truth: is the unit of depth right "
                    "(--depth-scale), and the lens?",
                    std::abs(scale), scale > 0 ? "larger" : "smaller"));
  }
  return doubts;
}

}  // namespace sgs::run
