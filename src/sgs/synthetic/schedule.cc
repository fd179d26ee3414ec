// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/schedule.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sgs/synthetic/camera_motion.h"
#include "sgs/synthetic/scene_table.h"

namespace sgs::synthetic {

namespace {

constexpr double kMargin_s = 0.03;  // of motion that is needed around each frame

// Images of the nominal rate that the motion is long enough for, and when the first one is due.
struct Span {
  double start_s, end_s;
  double whole_end_s;  // of the motion, however few images are asked for
  int most_images;
};

Span span_of(const SynthOptions& options, const Trajectory& motion) {
  const auto& poses = motion.poses();
  Span span{options.trajectory ? poses.front().timestamp_s + kMargin_s : 1.0,
            poses.back().timestamp_s - kMargin_s, 0, std::numeric_limits<int>::max()};
  span.whole_end_s = span.end_s;
  if (options.frames > 0) span.most_images = options.frames;
  if (!options.trajectory) {
    const int frames = find_scene(options.scene)->default_frames;
    span.most_images =
        std::min(span.most_images, static_cast<int>(std::lround(frames * options.rate_hz / 30)));
    span.whole_end_s = span.start_s + frames / 30.0;
  }
  return span;
}

// One clock for both images.
std::vector<FrameTimes> clocked_frames(const Sensor& sensor, const Span& span, double rate_hz) {
  std::vector<FrameTimes> frames;
  for (std::int64_t slot = 0; slot < span.most_images; ++slot) {
    // Microseconds, as a file of time stamps would hold them.
    const double t = std::round((span.start_s + static_cast<double>(slot) / rate_hz) * 1e6) / 1e6;
    if (t > span.end_s) break;
    if (sensor.frame_lost(slot)) continue;
    frames.push_back({slot, t, t + sensor.model().depth_delay_s, t, 0});
  }
  return frames;
}

// Both images lie within the motion, from the first row to the last.
bool moves_during(const FrameTimes& frame, const Trajectory& motion, const SensorModel& m) {
  const double color_s = std::max(kMargin_s, m.rolling_shutter_s + m.exposure.longest_s) / 2;
  const double depth_s = std::max(kMargin_s, m.infrared.readout_s) / 2;
  const auto moves = [&](double t) { return motion.at(t, kMaxPoseGap_s).has_value(); };
  const bool color =
      moves(frame.color_s) && moves(frame.color_s - color_s) && moves(frame.color_s + color_s);
  if (!m.clocks.free_running) return color;
  return color && moves(frame.depth_s - depth_s) && moves(frame.depth_s + depth_s);
}

Result<Trajectory> unmodified_motion(const SynthOptions& options) {
  if (options.trajectory) return *options.trajectory;
  return handheld_trajectory(options);
}

}  // namespace

Status check_options(const SynthOptions& o) {
  if (auto info = find_scene(o.scene); !info) return tl::unexpected<Error>(info.error());
  SGS_RETURN_IF_ERROR(check_level(o.level));
  if (!o.camera.valid() || o.camera.width < 32 || o.camera.height < 32)
    return fail(ErrorCode::kInvalidArgument, "synthetic camera: size or focal length is not usable",
                "give at least 32x32 pixels and positive focal lengths");
  if (o.frames < 0 || !(o.rate_hz > 0) || !std::isfinite(o.rate_hz))
    return fail(ErrorCode::kInvalidArgument,
                "synthetic sequence: frames must be >= 0 and the frame rate positive");
  if (o.trajectory && o.trajectory->size() < 2)
    return fail(ErrorCode::kInvalidArgument, "synthetic sequence: the trajectory has < 2 poses");
  return {};
}

Result<std::shared_ptr<const Scene>> scene_of(SynthOptions options, ThreadPool& pool) {
  SGS_RETURN_IF_ERROR(check_options(options));
  SGS_ASSIGN_OR_RETURN(const SceneInfo info, find_scene(options.scene));
  options.frames = 0;  // the layout must not depend on how many frames are asked for
  SGS_ASSIGN_OR_RETURN(const Trajectory motion, unmodified_motion(options));
  return build_scene(info, motion, options.camera, hash64(options.seed, hash_name(info.name)),
                     pool);
}

Result<Trajectory> motion_of(const SynthOptions& options) {
  SGS_ASSIGN_OR_RETURN(Trajectory motion, unmodified_motion(options));
  if (options.motion == CameraMotion::kAsGiven) return motion;
  SynthOptions whole = options;
  whole.frames = 0;
  SGS_ASSIGN_OR_RETURN(const Trajectory all, unmodified_motion(whole));
  return moved_otherwise(motion, all, options.motion);
}

Result<Trajectory> whole_motion_of(SynthOptions options) {
  options.frames = 0;
  return motion_of(options);
}

Schedule schedule_of(const SynthOptions& options, const Trajectory& motion, const Sensor& sensor) {
  const Span span = span_of(options, motion);
  const SensorModel& model = sensor.model();
  Schedule schedule;
  schedule.start_s = span.start_s;
  const auto frames = model.clocks.free_running
                          ? free_running_frames(model.clocks, span.start_s, span.whole_end_s,
                                                options.rate_hz, options.seed)
                          : clocked_frames(sensor, span, options.rate_hz);
  for (const FrameTimes& frame : frames) {
    if (frame.slot >= span.most_images) break;
    if (!moves_during(frame, motion, model)) continue;
    schedule.frames.push_back(frame);
    schedule.truth.push_back({frame.stamp_s, *motion.at(frame.color_s, kMaxPoseGap_s)});
  }
  return schedule;
}

std::vector<SE3> row_poses(const Trajectory& motion, const PinholeCamera& camera, double time_s,
                           double readout_s) {
  const auto pose = [&](double t) {
    const auto p = motion.at(t, kMaxPoseGap_s);
    SGS_CHECK(p.has_value(), "frame times lie inside the motion");
    return *p;
  };
  if (readout_s == 0) return {pose(time_s)};
  std::vector<SE3> rows;
  const int h = camera.height;
  for (int y = 0; y < h; ++y) rows.push_back(pose(time_s + ((y + 0.5) / h - 0.5) * readout_s));
  return rows;
}

}  // namespace sgs::synthetic
