// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/enum_names.h"
#include "sgs/tracker/tracker.h"

namespace sgs::slam {

/// What whoever holds the camera can do better.
enum class SceneWarning { kTooFast, kTooNear, kNothingSeen, kDark, kCrowded };
constexpr auto enum_names(SceneWarning) {
  using enum SceneWarning;
  return std::to_array<EnumName<SceneWarning>>({{kTooFast, "too_fast"},
                                                {kTooNear, "too_near"},
                                                {kNothingSeen, "nothing_seen"},
                                                {kDark, "dark"},
                                                {kCrowded, "crowded"}});
}
inline constexpr std::size_t kSceneWarnings = 5;

/// A switch that does not flicker: on once its measure has been at or above `on` for `frames_on`
/// frames in a row, off once it has been below `off` for `calm_s`.
class Hysteresis {
 public:
  struct Levels {
    double on, off;
    int frames_on;
    double calm_s;
  };
  explicit Hysteresis(const Levels& levels) : levels_(levels) {}
  /// Returns whether it is on; NaN: not measured, everything stays.
  bool add(double measure, double time_s);
  bool on() const { return on_; }

 private:
  Levels levels_;
  int above_ = 0;
  std::optional<double> calm_since_s_;
  bool on_ = false;
};

/// Looks at tracked frames and says when the one who holds the camera should hear something: it
/// moves too fast, is too near, sees no surface, sees nothing in the dark, or much that moves. All
/// levels are shares: of the image, or of what this camera usually gives. Costs a few thousand
/// pixels a frame. Never changes what is computed.
class SceneWatch {
 public:
  explicit SceneWatch(const PinholeCamera& camera) : camera_(camera) {}

  struct Change {
    SceneWarning warning;
    bool on;           ///< it begins; else it is over
    std::string text;  ///< what to tell, with what to do; empty where it is over
  };
  /// What begins and what is over with this frame. `T_world_camera` is where it was tracked,
  /// `moving` the share of what it shows that moves by itself (NaN: not known).
  std::vector<Change> add(const RgbdFrame& frame, tracker::TrackingStatus status,
                          const SE3& T_world_camera, double moving = 0);
  /// Frames were left out: the next one says nothing about motion.
  void forget_motion() { last_.reset(); }
  bool active(SceneWarning warning) const { return switch_of(warning).on(); }

 private:
  /// A frame in a few numbers.
  struct Look {
    double measured = 0;    ///< share of the pixels that have depth
    double middle_m = 0;    ///< median of those depths; 0: none
    double brightness = 0;  ///< mean, 0..1
  };
  struct Tracked {
    double time_s;
    SE3 T_world_camera;
  };
  static Look look_at(const RgbdFrame& frame);
  /// Mean way of the image between two tracked frames, as a share of its width; NaN: not known.
  double motion(const RgbdFrame& frame, const Look& look, tracker::TrackingStatus status,
                const SE3& T_world_camera);
  void learn(const Look& look);
  bool came_near(const Look& look) const;
  std::string text(SceneWarning warning, const Look& look, double motion, double moving) const;

  const Hysteresis& switch_of(SceneWarning w) const {
    return switches_[static_cast<std::size_t>(w)];
  }

  PinholeCamera camera_;
  std::optional<Tracked> last_;
  std::optional<double> usual_measured_, usual_middle_m_, usual_brightness_;
  double last_motion_ = std::numeric_limits<double>::quiet_NaN();
  double last_middle_m_ = 0;           // of the last frame that had depth to speak of
  std::int64_t looks_ = 0, seen_ = 0;  // learned from; of those in trouble
  // In the order of the warnings. Motion: share of the image's width per frame. Near and nothing:
  // share of the usual depth that is missing. Dark: share of the usual brightness that is missing.
  // Crowded: share that moves.
  std::array<Hysteresis, kSceneWarnings> switches_ = {
      Hysteresis({0.07, 0.045, 3, 0.5}), Hysteresis({0.5, 0.3, 5, 0.5}),
      Hysteresis({0.85, 0.7, 5, 0.5}), Hysteresis({0.85, 0.7, 5, 0.5}),
      Hysteresis({0.4, 0.25, 5, 1})};
};

}  // namespace sgs::slam
