// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/source.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

class SyntheticSource final : public dataset::FrameSource {
 public:
  SyntheticSource(const SynthOptions& options, std::shared_ptr<const Scene> scene,
                  Trajectory motion)
      : options_(options),
        scene_(std::move(scene)),
        motion_(std::move(motion)),
        sensor_(SensorModel::of_level(options.level, options.seed), options.camera, options.seed),
        pool_(std::max(1, options.threads)) {
    const auto& poses = motion_.poses();
    start_s_ = options.trajectory ? poses.front().timestamp_s + kMargin : 1.0;
    const double end_s = poses.back().timestamp_s - kMargin;
    int limit = options.frames > 0 ? options.frames : std::numeric_limits<int>::max();
    if (!options.trajectory)
      limit =
          std::min(limit, static_cast<int>(std::lround(find_scene(options.scene)->default_frames *
                                                       options.rate_hz / 30)));
    std::int64_t slot = 0;
    for (; slot < limit; ++slot) {
      // Microseconds, as a file of time stamps would hold them.
      const double t =
          std::round((start_s_ + static_cast<double>(slot) / options.rate_hz) * 1e6) / 1e6;
      if (t > end_s) break;
      if (sensor_.frame_lost(slot) || !moves_at(t)) continue;
      slots_.push_back(slot);
      truth_.push_back({t, *motion_.at(t, kMaxGap)});
    }
  }

  std::string name() const override { return "synth:" + options_.scene + ":" + options_.level; }
  PinholeCamera camera() const override { return options_.camera; }
  std::optional<std::int64_t> size() const override {
    return static_cast<std::int64_t>(slots_.size());
  }
  const Trajectory& ground_truth() const override { return truth_; }

  dataset::FrameRead next(RgbdFrame& frame, Error&) override {
    if (next_ >= slots_.size()) return dataset::FrameRead::kEnd;
    const StampedPose& truth = truth_.poses()[next_];
    const double t = truth.timestamp_s;
    const SensorModel& model = sensor_.model();
    const std::vector<SE3> rows = row_poses(t);
    RayImage view = cast_rays(*scene_, options_.camera, rows, {0, 0}, true, pool_);
    smooth_silhouettes(view, pool_);
    frame.index = static_cast<std::int64_t>(next_);
    frame.timestamp_s = t;
    frame.camera = options_.camera;
    frame.truth_T_world_camera = truth.T_world_camera;
    SE3 half_motion;
    if (model.exposure_s > 0)
      half_motion = pose(t + model.exposure_s / 2).inverse() * truth.T_world_camera;
    const std::int64_t slot = slots_[next_];
    frame.color = sensor_.color(view, half_motion, sensor_.gain(t - start_s_), slot, pool_);
    if (model.hard)
      view = cast_rays(*scene_, options_.camera, row_poses(t + model.depth_delay_s),
                       sensor_.registration_shift(), false, pool_);
    frame.depth = sensor_.depth(view, slot, pool_);
    ++next_;
    return dataset::FrameRead::kOk;
  }

 private:
  bool moves_at(double t) const {
    return motion_.at(t, kMaxGap) && motion_.at(t - kMargin / 2, kMaxGap) &&
           motion_.at(t + kMargin / 2, kMaxGap);
  }
  SE3 pose(double t) const {
    const auto p = motion_.at(t, kMaxGap);
    SGS_CHECK(p.has_value(), "frame times lie inside the motion");
    return *p;
  }
  std::vector<SE3> row_poses(double t) const {
    const double rolling = sensor_.model().rolling_shutter_s;
    if (rolling == 0) return {pose(t)};
    std::vector<SE3> rows;
    const int h = options_.camera.height;
    for (int y = 0; y < h; ++y) rows.push_back(pose(t + ((y + 0.5) / h - 0.5) * rolling));
    return rows;
  }

  SynthOptions options_;
  std::shared_ptr<const Scene> scene_;
  Trajectory motion_, truth_;
  Sensor sensor_;
  ThreadPool pool_;
  double start_s_ = 0;
  std::vector<std::int64_t> slots_;  // frame periods since the start, lost ones left out
  std::size_t next_ = 0;
};

}  // namespace

Result<std::shared_ptr<const Scene>> make_scene(const SynthOptions& options) {
  ThreadPool pool(std::max(1, options.threads));
  return scene_of(options, pool);
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
