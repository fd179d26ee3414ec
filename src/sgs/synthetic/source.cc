// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/source.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sgs/camera/pair_rectifier.h"
#include "sgs/synthetic/auto_exposure.h"
#include "sgs/synthetic/clocks.h"
#include "sgs/synthetic/color_camera.h"
#include "sgs/synthetic/infrared.h"
#include "sgs/synthetic/scene_table.h"
#include "sgs/synthetic/sensor.h"

namespace sgs::synthetic {

namespace {

constexpr double kMaxGap = 0.5;   // seconds between poses of a given trajectory
constexpr double kMargin = 0.03;  // seconds of motion needed around each frame

Status check(const SynthOptions& o) {
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

Result<Trajectory> motion_of(const SynthOptions& options) {
  if (options.trajectory) return *options.trajectory;
  return handheld_trajectory(options);
}

// The layout must not depend on how many frames are asked for.
Result<std::shared_ptr<const Scene>> scene_of(SynthOptions options, ThreadPool& pool) {
  SGS_RETURN_IF_ERROR(check(options));
  SGS_ASSIGN_OR_RETURN(const SceneInfo info, find_scene(options.scene));
  options.frames = 0;
  SGS_ASSIGN_OR_RETURN(const Trajectory motion, motion_of(options));
  return build_scene(info, motion, options.camera, hash64(options.seed, hash_name(info.name)),
                     pool);
}

// Images of the nominal rate that the motion is long enough for, and when the first one is due.
struct Span {
  double start_s, end_s;
  double whole_end_s;  // of the motion, however few images are asked for
  int most_images;
};

Span span_of(const SynthOptions& options, const Trajectory& motion) {
  const auto& poses = motion.poses();
  Span span{options.trajectory ? poses.front().timestamp_s + kMargin : 1.0,
            poses.back().timestamp_s - kMargin, 0, std::numeric_limits<int>::max()};
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

class SyntheticSource final : public dataset::FrameSource {
 public:
  SyntheticSource(const SynthOptions& options, std::shared_ptr<const Scene> scene,
                  Trajectory motion)
      : options_(options),
        scene_(std::move(scene)),
        motion_(std::move(motion)),
        sensor_(SensorModel::of_level(options.level, options.seed), options.camera, options.seed),
        pool_(std::max(1, options.threads)) {
    const Span span = span_of(options, motion_);
    start_s_ = span.start_s;
    const SensorModel& model = sensor_.model();
    if (model.response.camera) real_.emplace(model, *scene_, sensor_.registration_shift(), options);
    const auto frames = model.clocks.free_running
                            ? free_running_frames(model.clocks, start_s_, span.whole_end_s,
                                                  options.rate_hz, options.seed)
                            : clocked_frames(sensor_, span, options.rate_hz);
    for (const FrameTimes& frame : frames) {
      if (frame.slot >= span.most_images) break;
      if (!moves_during(frame)) continue;
      frames_.push_back(frame);
      truth_.push_back({frame.stamp_s, *motion_.at(frame.color_s, kMaxGap)});
    }
  }

  std::string name() const override { return "synth:" + options_.scene + ":" + options_.level; }
  PinholeCamera camera() const override { return options_.camera; }
  std::optional<std::int64_t> size() const override {
    return static_cast<std::int64_t>(frames_.size());
  }
  const Trajectory& ground_truth() const override { return truth_; }

  dataset::FrameRead next(RgbdFrame& frame, Error&) override {
    if (next_ >= frames_.size()) return dataset::FrameRead::kEnd;
    const FrameTimes& times = frames_[next_];
    const StampedPose& truth = truth_.poses()[next_];
    frame.index = static_cast<std::int64_t>(next_);
    frame.timestamp_s = times.stamp_s;
    frame.camera = options_.camera;
    frame.depth_delay_s = times.stamped_delay_s;
    frame.truth_T_world_camera = truth.T_world_camera;
    if (real_)
      render_real(times, truth.T_world_camera, frame);
    else
      render(times, truth.T_world_camera, frame);
    ++next_;
    return dataset::FrameRead::kOk;
  }

 private:
  // What level `real` has of its own.
  struct Real {
    ColorCamera color;
    AutoExposure exposure;
    Infrared infrared;
    Sensor depth;
    PairRectifier rectifier;

    Real(const SensorModel& model, const Scene& scene, const Eigen::Vector2d& shift_px,
         const SynthOptions& options)
        : Real(model, scene, shift_px, options, LensCamera{options.camera, model.lens}) {}

   private:
    Real(const SensorModel& model, const Scene& scene, const Eigen::Vector2d& shift_px,
         const SynthOptions& options, const LensCamera& lens)
        : color(model.response, std::make_shared<LensRays>(lens), options.seed),
          exposure(model.exposure, color),
          infrared(model.infrared, scene, lens, shift_px, options.seed),
          depth(model, infrared.camera(), options.seed),
          rectifier(lens, std::nullopt, SE3()) {}
  };

  void render(const FrameTimes& times, const SE3& middle, RgbdFrame& frame) {
    const SensorModel& model = sensor_.model();
    RayRequest request{options_.camera, row_poses(times.color_s, model.rolling_shutter_s)};
    request.with_color = true;
    RayImage view = cast_rays(*scene_, request, pool_);
    smooth_silhouettes(view, pool_);
    SE3 half_motion;
    if (model.exposure_s > 0)
      half_motion = pose(times.color_s + model.exposure_s / 2).inverse() * middle;
    frame.color =
        sensor_.color(view, half_motion, sensor_.gain(times.color_s - start_s_), times.slot, pool_);
    if (model.hard) {
      request = {options_.camera, row_poses(times.depth_s, model.rolling_shutter_s)};
      request.shift_px = sensor_.registration_shift();
      view = cast_rays(*scene_, request, pool_);
    }
    frame.depth = sensor_.depth(view, times.slot, pool_);
  }

  void render_real(const FrameTimes& times, const SE3& middle, RgbdFrame& frame) {
    ColorImage color = real_color(times, middle);
    DepthImage depth = real_depth(times);
    if (options_.as_recorded) {
      frame.color = std::move(color);
      frame.depth = std::move(depth);
    } else {
      real_->rectifier.rectify(std::move(color), std::move(depth), frame);
    }
  }

  ColorImage real_color(const FrameTimes& times, const SE3& middle) {
    RayRequest request{options_.camera,
                       row_poses(times.color_s, sensor_.model().rolling_shutter_s)};
    request.lens = &real_->color.lens();
    request.with_color = true;
    RayImage view = cast_rays(*scene_, request, pool_);
    smooth_silhouettes(view, pool_);
    if (next_ == 0) real_->exposure.settle(view);
    const Exposure& exposure = real_->exposure.exposure();
    const SE3 half_motion = pose(times.color_s + exposure.time_s / 2).inverse() * middle;
    ColorImage color = real_->color.picture(view, half_motion, exposure, times.slot, pool_);
    real_->exposure.advance(view);
    return color;
  }

  DepthImage real_depth(const FrameTimes& times) {
    RayRequest request{real_->infrared.camera(),
                       row_poses(times.depth_s, sensor_.model().infrared.readout_s)};
    for (SE3& pose : request.row_poses) pose = pose * real_->infrared.T_color_infrared();
    request.with_paint = true;
    const RayImage seen = cast_rays(*scene_, request, pool_);
    const RayImage matched = real_->infrared.matched(seen, times.slot, pool_);
    return real_->infrared.registered(real_->depth.depth(matched, times.slot, pool_));
  }

  // Both images lie within the motion, from the first row to the last.
  bool moves_during(const FrameTimes& frame) const {
    const SensorModel& m = sensor_.model();
    const double color_s = std::max(kMargin, m.rolling_shutter_s + m.exposure.longest_s) / 2;
    const double depth_s = std::max(kMargin, m.infrared.readout_s) / 2;
    const auto moves = [&](double t) { return motion_.at(t, kMaxGap).has_value(); };
    const bool color =
        moves(frame.color_s) && moves(frame.color_s - color_s) && moves(frame.color_s + color_s);
    if (!m.clocks.free_running) return color;
    return color && moves(frame.depth_s - depth_s) && moves(frame.depth_s + depth_s);
  }
  SE3 pose(double t) const {
    const auto p = motion_.at(t, kMaxGap);
    SGS_CHECK(p.has_value(), "frame times lie inside the motion");
    return *p;
  }
  std::vector<SE3> row_poses(double t, double rolling_s) const {
    if (rolling_s == 0) return {pose(t)};
    std::vector<SE3> rows;
    const int h = options_.camera.height;
    for (int y = 0; y < h; ++y) rows.push_back(pose(t + ((y + 0.5) / h - 0.5) * rolling_s));
    return rows;
  }

  SynthOptions options_;
  std::shared_ptr<const Scene> scene_;
  Trajectory motion_, truth_;
  Sensor sensor_;
  ThreadPool pool_;
  double start_s_ = 0;
  std::optional<Real> real_;
  std::vector<FrameTimes> frames_;
  std::size_t next_ = 0;
};

}  // namespace

Result<std::shared_ptr<const Scene>> make_scene(const SynthOptions& options) {
  ThreadPool pool(std::max(1, options.threads));
  return scene_of(options, pool);
}

Distortion synth_lens(const SynthOptions& options) {
  return SensorModel::of_level(options.level, options.seed).lens;
}

Result<std::unique_ptr<dataset::FrameSource>> make_synthetic_source(const SynthOptions& options) {
  SGS_ASSIGN_OR_RETURN(std::shared_ptr<const Scene> scene, make_scene(options));
  SGS_ASSIGN_OR_RETURN(Trajectory motion, motion_of(options));
  auto source = std::make_unique<SyntheticSource>(options, std::move(scene), std::move(motion));
  if (source->size() == 0)
    return fail(ErrorCode::kInvalidArgument, "synthetic sequence: no frame fits the trajectory",
                "the trajectory must cover at least 0.1 s without gaps over 0.5 s");
  return source;
}

}  // namespace sgs::synthetic
