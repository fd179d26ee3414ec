// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/camera/pair_rectifier.h"
#include "sgs/synthetic/auto_exposure.h"
#include "sgs/synthetic/color_camera.h"
#include "sgs/synthetic/crowd.h"
#include "sgs/synthetic/infrared.h"
#include "sgs/synthetic/schedule.h"

namespace sgs::synthetic {

namespace {

class SyntheticSource final : public dataset::FrameSource {
 public:
  SyntheticSource(const SynthOptions& options, std::shared_ptr<const Scene> scene,
                  Trajectory motion, const Trajectory& whole_motion)
      : options_(options),
        scene_(std::move(scene)),
        motion_(std::move(motion)),
        sensor_(SensorModel::of_level(options.level, options.seed), options.camera, options.seed),
        pool_(std::max(1, options.threads)),
        schedule_(schedule_of(options, motion_, sensor_)) {
    if (!options.crowd.empty()) crowd_.emplace(options, *scene_, whole_motion, pool_);
    const SensorModel& model = sensor_.model();
    if (!model.response.camera) return;
    const std::vector<Primitive> movers = movers_at(schedule_.start_s);
    real_.emplace(model, *scene_, movers, sensor_.registration_shift(), options);
  }

  std::string name() const override {
    return "synth:" + scene_text(options_) + ":" + options_.level;
  }
  PinholeCamera camera() const override { return options_.camera; }
  std::optional<std::int64_t> size() const override {
    return static_cast<std::int64_t>(schedule_.frames.size());
  }
  const Trajectory& ground_truth() const override { return schedule_.truth; }

  dataset::FrameRead next(RgbdFrame& frame, Error&) override {
    if (next_ >= schedule_.frames.size()) return dataset::FrameRead::kEnd;
    const FrameTimes& times = schedule_.frames[next_];
    const StampedPose& truth = schedule_.truth.poses()[next_];
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

    Real(const SensorModel& model, const Scene& scene, std::span<const Primitive> movers,
         const Eigen::Vector2d& shift_px, const SynthOptions& options)
        : Real(model, scene, movers, shift_px, options, LensCamera{options.camera, model.lens}) {}

   private:
    Real(const SensorModel& model, const Scene& scene, std::span<const Primitive> movers,
         const Eigen::Vector2d& shift_px, const SynthOptions& options, const LensCamera& lens)
        : color(model.response, std::make_shared<LensRays>(lens), options.seed),
          exposure(model.exposure, color),
          infrared(model.infrared, scene, movers, lens, shift_px, options.seed),
          depth(model, infrared.camera(), options.seed),
          rectifier(lens, std::nullopt, SE3()) {}
  };

  void render(const FrameTimes& times, const SE3& middle, RgbdFrame& frame) {
    const SensorModel& model = sensor_.model();
    const std::vector<Primitive> movers = movers_at(times.color_s);
    RayRequest request{options_.camera, rows(times.color_s, model.rolling_shutter_s)};
    request.movers = movers;
    request.with_color = true;
    RayImage view = cast_rays(*scene_, request, pool_);
    smooth_silhouettes(view, pool_);
    SE3 half_motion;
    if (model.exposure_s > 0)
      half_motion = pose(times.color_s + model.exposure_s / 2).inverse() * middle;
    frame.color = sensor_.color(view, half_motion, sensor_.gain(times.color_s - schedule_.start_s),
                                times.slot, pool_);
    if (model.hard) {
      const std::vector<Primitive> later = movers_at(times.depth_s);
      request = {options_.camera, rows(times.depth_s, model.rolling_shutter_s)};
      request.movers = later;
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
    const std::vector<Primitive> movers = movers_at(times.color_s);
    RayRequest request{options_.camera, rows(times.color_s, sensor_.model().rolling_shutter_s)};
    request.movers = movers;
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
    const std::vector<Primitive> movers = movers_at(times.depth_s);
    RayRequest request{real_->infrared.camera(),
                       rows(times.depth_s, sensor_.model().infrared.readout_s)};
    request.movers = movers;
    for (SE3& pose : request.row_poses) pose = pose * real_->infrared.T_color_infrared();
    request.with_paint = true;
    const RayImage seen = cast_rays(*scene_, request, pool_);
    const RayImage matched = real_->infrared.matched(seen, times.slot, pool_);
    return real_->infrared.registered(real_->depth.depth(matched, times.slot, pool_));
  }

  SE3 pose(double t) const { return row_poses(motion_, options_.camera, t, 0).front(); }
  std::vector<SE3> rows(double t, double readout_s) const {
    return row_poses(motion_, options_.camera, t, readout_s);
  }
  std::vector<Primitive> movers_at(double t) const {
    return crowd_ ? crowd_->at(t) : std::vector<Primitive>();
  }

  SynthOptions options_;
  std::shared_ptr<const Scene> scene_;
  Trajectory motion_;
  Sensor sensor_;
  ThreadPool pool_;
  Schedule schedule_;
  std::optional<Crowd> crowd_;
  std::optional<Real> real_;
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
  SGS_ASSIGN_OR_RETURN(const Trajectory whole, whole_motion_of(options));
  auto source =
      std::make_unique<SyntheticSource>(options, std::move(scene), std::move(motion), whole);
  if (source->size() == 0)
    return fail(ErrorCode::kInvalidArgument, "synthetic sequence: no frame fits the trajectory",
                "the trajectory must cover at least 0.1 s without gaps over 0.5 s");
  return source;
}

}  // namespace sgs::synthetic
