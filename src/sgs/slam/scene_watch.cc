// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/scene_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sgs::slam {
namespace {

constexpr double kSomeDepth = 0.05;  // of the pixels: enough to tell how far away they are
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Follows slowly: what is usual is not what the last second was.
void follow(std::optional<double>& usual, double value, std::int64_t looks) {
  constexpr double kFrames = 300;
  if (!usual) usual = value;
  *usual += (value - *usual) / std::min(kFrames, static_cast<double>(looks));
}

double share_missing(double value, const std::optional<double>& usual) {
  return usual && *usual > 0 ? std::clamp(1 - value / *usual, 0.0, 1.0) : kUnknown;
}

int percent(double share) { return static_cast<int>(std::lround(100 * share)); }

}  // namespace

bool Hysteresis::add(double measure, double time_s) {
  if (std::isnan(measure)) return on_;
  above_ = measure >= levels_.on ? above_ + 1 : 0;
  if (above_ >= levels_.frames_on) on_ = true;
  if (measure >= levels_.off) {
    calm_since_s_.reset();
  } else {
    if (!calm_since_s_) calm_since_s_ = time_s;
    if (time_s - *calm_since_s_ >= levels_.calm_s) on_ = false;
  }
  return on_;
}

SceneWatch::Look SceneWatch::look_at(const RgbdFrame& frame) {
  constexpr int kStep_px = 8;
  Look look;
  std::vector<float> depths;
  std::int64_t pixels = 0, sum = 0;
  for (int v = kStep_px / 2; v < frame.depth.height(); v += kStep_px) {
    for (int u = kStep_px / 2; u < frame.depth.width(); u += kStep_px) {
      if (!frame.sees(u, v)) continue;
      ++pixels;
      const Rgb8& c = frame.color(u, v);
      sum += c.r + c.g + c.b;
      if (const float z = frame.depth(u, v); z > 0) depths.push_back(z);
    }
  }
  if (pixels == 0) return look;
  constexpr double kWhite = 3 * 255.0;
  look.measured = static_cast<double>(depths.size()) / static_cast<double>(pixels);
  look.brightness = static_cast<double>(sum) / (kWhite * static_cast<double>(pixels));
  if (!depths.empty()) {
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    look.middle_m = *middle;
  }
  return look;
}

double SceneWatch::motion(const RgbdFrame& frame, const Look& look, tracker::TrackingStatus status,
                          const SE3& T_world_camera) {
  constexpr double kLongest_s = 0.5;  // beyond it lies a gap, not a motion
  if (status == tracker::TrackingStatus::kLost || !(look.middle_m > 0)) {
    last_.reset();
    return std::exchange(last_motion_, kUnknown);  // lost in the middle of it
  }
  const auto before = std::exchange(last_, Tracked{frame.timestamp_s, T_world_camera});
  if (!before || !(frame.timestamp_s - before->time_s < kLongest_s)) return kUnknown;
  const SE3 T_before_now = before->T_world_camera.inverse() * T_world_camera;
  // The middle of the image's four quarters, as far away as the scene is in the middle.
  double sum = 0;
  for (const double y : {0.25, 0.75}) {
    for (const double x : {0.25, 0.75}) {
      const Eigen::Vector2d pixel(x * camera_.width, y * camera_.height);
      const Eigen::Vector3d ray((pixel.x() - camera_.cx) / camera_.fx,
                                (pixel.y() - camera_.cy) / camera_.fy, 1);
      const Eigen::Vector3d p = T_before_now * Eigen::Vector3d(look.middle_m * ray);
      if (!(p.z() > 0)) return 1;  // it has left the image
      const Eigen::Vector2d there(camera_.fx * p.x() / p.z() + camera_.cx,
                                  camera_.fy * p.y() / p.z() + camera_.cy);
      sum += (there - pixel).norm();
    }
  }
  return last_motion_ = std::min(1.0, sum / 4 / camera_.width);
}

void SceneWatch::learn(const Look& look) {
  ++looks_;
  follow(usual_measured_, look.measured, looks_);
  follow(usual_brightness_, look.brightness, looks_);
  if (look.middle_m > 0) follow(usual_middle_m_, look.middle_m, looks_);
}

// Before depth went missing the scene was nearer than it usually is: the sensor's nearest distance
// was passed. What it is nobody says.
bool SceneWatch::came_near(const Look& look) const {
  constexpr double kNear = 0.6;
  const double middle_m = look.measured > kSomeDepth ? look.middle_m : last_middle_m_;
  return usual_middle_m_ && middle_m > 0 && middle_m < kNear * *usual_middle_m_;
}

std::string SceneWatch::text(SceneWarning warning, const Look& look, double motion,
                             double moving) const {
  switch (warning) {
    case SceneWarning::kTooFast:
      return fmt::format(
          "the camera moves too fast: by {} % of the image from frame to frame. Move more slowly",
          percent(motion));
    case SceneWarning::kTooNear:
      return fmt::format("the camera is too near: depth is missing in {} % of the image. Step back",
                         percent(1 - look.measured));
    case SceneWarning::kNothingSeen:
      return fmt::format(
          "the camera sees no surface: {} % of the image have depth. Turn back to where it saw one",
          percent(look.measured));
    case SceneWarning::kCrowded:
      return fmt::format(
          "the room is crowded: {} % of what is seen moves and is left out. Keep what stands still "
          "in view",
          percent(moving));
    case SceneWarning::kDark:
      break;
  }
  return "it is dark: colours say nothing. Switch the light on, or turn back";
}

std::vector<SceneWatch::Change> SceneWatch::add(const RgbdFrame& frame,
                                                tracker::TrackingStatus status,
                                                const SE3& T_world_camera, double moving) {
  constexpr double kBlack = 0.02;    // of white: dark also where it was so from the beginning
  constexpr double kNoDepth = 0.02;  // of the pixels: nothing, likewise
  const Look look = look_at(frame);
  const double moved = motion(frame, look, status, T_world_camera);
  const double missing = share_missing(look.measured, usual_measured_);
  const bool near = came_near(look);
  const double nothing = look.measured < kNoDepth ? 1.0 : missing;
  const double dark =
      look.brightness < kBlack ? 1.0 : share_missing(look.brightness, usual_brightness_);
  // One of the two says why depth is missing.
  const bool says_near = active(SceneWarning::kTooNear);
  const bool says_nothing = active(SceneWarning::kNothingSeen);
  const std::array<double, kSceneWarnings> measures = {
      moved, says_near || (near && !says_nothing) ? missing : 0.0,
      says_nothing || (!near && !says_near) ? nothing : 0.0, dark, moving};
  std::vector<Change> changes;
  for (std::size_t k = 0; k < kSceneWarnings; ++k) {
    const bool before = switches_[k].on();
    const bool now = switches_[k].add(measures[k], frame.timestamp_s);
    if (now == before) continue;
    const auto warning = static_cast<SceneWarning>(k);
    changes.push_back({warning, now, now ? text(warning, look, moved, moving) : std::string()});
  }
  // What is a trouble is not what is usual, unless it lasts.
  constexpr double kTrouble = 0.3;
  constexpr std::int64_t kSlower = 10;
  const bool well =
      std::none_of(measures.begin() + 1, measures.end(), [](double m) { return m >= kTrouble; });
  if (well || seen_++ % kSlower == 0) learn(look);
  if (look.measured > kSomeDepth) last_middle_m_ = look.middle_m;
  return changes;
}

}  // namespace sgs::slam
