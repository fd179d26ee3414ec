// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/camera/depth_lag.h"
#include "sgs/camera/fingerprint.h"
#include "sgs/camera/movers.h"
#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/refine/shutter.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/runfolder/run_files.h"
#include "sgs/stream/address.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTime_s = 2e-6;  // frames.csv keeps nine digits, trajectories too

/// What a run and its recording give to learn from.
struct Material {
  std::vector<refine::RefineFrame> training, heldout;
};

Error differs(const Run& run, std::int64_t index, const std::string& how) {
  return {ErrorCode::kInvalidArgument,
          fmt::format("frame {} of {} is not the one that the run saw: {}", index, run.input.input,
                      how),
          "bring the recording of the run back, or run `sgs run` on the new one"};
}

/// Whether `frame` is the one behind `record`.
Status check_same(const Run& run, const slam::FrameRecord& record, const RgbdFrame& frame) {
  if (std::abs(record.timestamp_s - frame.timestamp_s) > kSameTime_s) {
    return tl::unexpected(differs(run, frame.index,
                                  fmt::format("its time is {:.6f} s instead of {:.6f} s",
                                              frame.timestamp_s, record.timestamp_s)));
  }
  if (frame.camera.width != run.camera.width || frame.camera.height != run.camera.height) {
    return tl::unexpected(
        differs(run, frame.index,
                fmt::format("it has {}x{} pixels instead of {}x{}", frame.camera.width,
                            frame.camera.height, run.camera.width, run.camera.height)));
  }
  if (record.fingerprint != 0 && record.fingerprint != fingerprint(frame)) {
    return tl::unexpected(differs(run, frame.index, "its pixels are others"));
  }
  return {};
}

Result<Input> open_recording(const Run& run, int threads) {
  auto input = reopen_input(run.input, threads);
  if (input || stream::is_stream(run.input.input)) return input;
  Error error = input.error();
  error.message = fmt::format("the recording of the run, {}, cannot be opened: {}", run.input.input,
                              error.message);
  error.remedy = "bring it back to that place; a map cannot be refined without its pictures";
  return tl::unexpected(error);
}

/// What the run learned of its depth camera, where the recording's depth is as it was measured.
Result<const DepthCalibration*> learned_calibration(const Run& run, const Input& input) {
  if (!run.calibration || input.calibration) return nullptr;
  const PinholeCamera made_for = run.calibration->camera, camera = input.source->camera();
  if (made_for.width == camera.width && made_for.height == camera.height) {
    return &*run.calibration;
  }
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} of the run is for {} x {} pixels, its recording has {} x {}",
                          files::kCalibration, made_for.width, made_for.height, camera.width,
                          camera.height),
              "bring the recording of the run back, or run `sgs run` on the new one");
}

/// The largest number of frames that are kept to judge: more tell no more.
constexpr std::int64_t kMostJudges = 96;

std::int64_t count_heldout(const Run& run) {
  std::int64_t count = 0;
  for (const slam::FrameRecord& record : run.frames) count += record.heldout ? 1 : 0;
  return count;
}

/// As the tracker had learned it in the end; 0 where it never did.
double learned_readout_s(const Run& run) {
  for (auto record = run.frames.rbegin(); record != run.frames.rend(); ++record) {
    const double readout_s = record->diagnostics.readout_s;
    if (!record->bad && std::isfinite(readout_s)) return readout_s;
  }
  return 0;
}

/// Goes through the recording once, checks every frame against the run's record, and keeps those
/// that are tracked.
Result<Material> read_material(const Run& run, const RefineOptions& options, RunObserver& observer,
                               const std::stop_token& stop) {
  SGS_ASSIGN_OR_RETURN(const auto input, open_recording(run, options.threads));
  SGS_ASSIGN_OR_RETURN(const DepthCalibration* calibration, learned_calibration(run, input));
  dataset::FrameSource& source = *input.source;
  const std::stop_callback wake(stop, [&] { source.stop(); });
  const std::int64_t judges_apart = (count_heldout(run) + kMostJudges - 1) / kMostJudges;
  const auto budget = static_cast<std::size_t>(options.config.memory_mb) << 20;
  refine::FrameSelection training(run.camera, static_cast<std::int64_t>(run.frames.size()),
                                  budget / 4 * 3);
  refine::FrameSelection heldout(run.camera, 1, budget);
  const double readout_s = options.config.rolling_shutter ? learned_readout_s(run) : 0;
  const double learned_delay = learned_depth_delay_s(run);
  const Trajectory views = view_poses(run);
  auto record = run.frames.begin();
  std::int64_t read = 0, heldout_seen = 0;
  RgbdFrame frame;
  Error error;
  while (record != run.frames.end() && !stop.stop_requested()) {
    const auto status = source.next(frame, error);
    if (status == dataset::FrameRead::kEnd) break;
    observer.on_frames_read(++read);
    // Frames that a live run dropped, and those that could not be read, have no pose.
    while (record != run.frames.end() && record->index < frame.index) ++record;
    if (record == run.frames.end() || record->index != frame.index || record->bad) continue;
    if (status == dataset::FrameRead::kBadFrame) {
      return tl::unexpected(differs(run, frame.index, error.message));
    }
    SGS_RETURN_IF_ERROR(check_same(run, *record, frame));
    const auto pose = views.at(frame.timestamp_s, 0.0);
    const bool lost = record->status == tracker::TrackingStatus::kLost;
    if (lost || !pose || !pose->all_finite()) continue;
    // Only now: the fingerprint is that of the recording.
    if (calibration != nullptr) frame.depth = calibration->apply(frame.depth);
    leave_out_movers(frame, still_from_blocks(record->movers, run.camera.width, run.camera.height));
    const double delay_s = frame.depth_delay_s + learned_delay;
    frame.depth = depth_with_colour(frame.depth, frame.camera,
                                    refine::twist_at(views, frame.timestamp_s, delay_s));
    const Vector6d readout = refine::twist_at(views, frame.timestamp_s, readout_s);
    if (!record->heldout) {
      training.offer(frame, *pose, readout);
    } else if (heldout_seen++ % judges_apart == 0) {
      heldout.offer(frame, *pose, readout);
    }
  }
  if (stop.stop_requested()) {
    return fail(ErrorCode::kInterrupted, "stopped before anything was learnt");
  }
  const auto last = std::find_if(run.frames.rbegin(), run.frames.rend(),
                                 [](const slam::FrameRecord& r) { return !r.bad; });
  if (last != run.frames.rend() && frame.index < last->index) {
    return tl::unexpected(differs(run, frame.index + 1,
                                  fmt::format("the recording ends before it; the run had frames up "
                                              "to {}",
                                              last->index)));
  }
  Material material{training.finish(), heldout.finish()};
  if (material.training.empty()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} has no tracked frame to learn from", run.name),
                "refine a run that was tracked");
  }
  if (training.group() > 1) {
    log().info("of each {} frames the sharpest one is used: refine.memory_mb holds no more",
               training.group());
  }
  return material;
}

Trajectory moved(const Trajectory& poses, const PoseCorrection& correction) {
  if (correction.empty()) return poses;
  std::vector<StampedPose> after = poses.poses();
  for (StampedPose& pose : after) {
    pose.T_world_camera = correction.corrected(pose.T_world_camera, pose.timestamp_s);
  }
  return Trajectory(std::move(after));
}

/// The run at a state of its refinement; its path is the one that its pictures are rendered from.
Run run_at(const Run& run, const std::vector<map::Gaussian>& gaussians,
           const map::Harmonics& harmonics, const PoseCorrection& correction,
           const refine::ExposureCurve& exposures) {
  constexpr std::int64_t kBytesPerGaussian = sizeof(map::Gaussian);
  Run at = run;
  at.gaussians = gaussians;
  at.harmonics = harmonics;
  at.trajectory = moved(view_poses(run), correction);
  at.keyframes = moved(run.keyframes, correction);
  for (slam::FrameRecord& record : at.frames) {
    if (record.bad || exposures.empty()) continue;
    const auto gain = exposures.at(record.timestamp_s);
    record.gain = {gain[0], gain[1], gain[2]};
  }
  at.metrics.gaussians = static_cast<std::int64_t>(gaussians.size());
  at.metrics.map_bytes =
      (kBytesPerGaussian + static_cast<std::int64_t>(sizeof(float) * harmonics.floats())) *
      *at.metrics.gaussians;
  eval::replace_group(at.metrics, eval::kRenderingGroup, {});
  return at;
}

}  // namespace

refine::Budget budget_by_frames(const refine::RefineConfig& config, const Run& run) {
  const auto frames = static_cast<double>(run.frames.size());
  const std::int64_t steps = std::llround(config.steps_per_frame * frames);
  return {std::max<std::int64_t>(config.least_steps, steps), 0};
}

Result<Run> run_of_map(const InputSpec& spec, map::SplatMap map, Trajectory poses,
                       const RunConfig& config, int threads) {
  constexpr double kMaxGap_s = 0.5;  // between two poses that a frame may lie between
  SGS_ASSIGN_OR_RETURN(const auto input, reopen_input(spec, threads));
  Run run = beginning_of(input, spec, config);
  run.gaussians = std::move(map.gaussians);
  run.harmonics = std::move(map.harmonics);
  RgbdFrame frame;
  Error error;
  while (true) {
    const auto status = input.source->next(frame, error);
    if (status == dataset::FrameRead::kEnd) break;
    slam::FrameRecord record;
    record.index = frame.index;
    record.timestamp_s = frame.timestamp_s;
    record.bad = status == dataset::FrameRead::kBadFrame;
    const auto pose = poses.at(frame.timestamp_s, kMaxGap_s);
    if (!record.bad && pose) {
      record.status = tracker::TrackingStatus::kOk;
      record.heldout = is_heldout(frame.index, config.session.heldout_interval);
      record.fingerprint = fingerprint(frame);
      run.trajectory.push_back({frame.timestamp_s, *pose});
    }
    run.frames.push_back(std::move(record));
  }
  run.frames_total = static_cast<std::int64_t>(run.frames.size());
  run.keyframes = run.trajectory;
  if (run.trajectory.empty()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("none of the {} frames of {} lies in the time of the poses",
                            run.frames.size(), spec.input),
                "give poses with the time stamps of the colour images, one TUM row each");
  }
  return run;
}

Result<RefinedRun> refine_run(const Run& run, const RefineOptions& options, RunFolder& folder,
                              RunObserver& observer, const std::stop_token& stop) {
  if (run.gaussians.empty()) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} has no map", run.name),
                "refine a run that mapped something");
  }
  SGS_ASSIGN_OR_RETURN(auto material, read_material(run, options, observer, stop));
  RefinedRun out;
  out.frames_used = static_cast<std::int64_t>(material.training.size());
  out.frames_heldout = static_cast<std::int64_t>(material.heldout.size());
  ThreadPool pool(options.threads);
  refine::Refiner refiner(options.config, run.config.seed, std::move(material.training),
                          std::move(material.heldout), {run.gaussians, run.harmonics}, &pool);
  double kept_s = wall_time_s();
  const auto checked = [&](const refine::Evaluation& now) {
    observer.on_evaluation(now);
    if (now.best && now.steps > 0) {
      observer.on_better_map({refiner.best_gaussians(), refiner.best_harmonics()});
    }
    const bool due = options.keep_every_s > 0 && wall_time_s() - kept_s > options.keep_every_s;
    if (!now.best || !due || now.steps == 0) return;
    save_run(run_at(run, refiner.best_gaussians(), refiner.best_harmonics(),
                    refiner.best_correction(), refiner.best_exposures()),
             folder);
    kept_s = wall_time_s();
  };
  out.refined = refiner.run(options.budget, checked, stop);
  out.run = run_at(run, out.refined.gaussians, out.refined.harmonics, out.refined.correction,
                   out.refined.exposures);
  out.run.metrics.mapping_iterations =
      run.metrics.mapping_iterations.value_or(0) + out.refined.best.steps;
  out.run.state = {};
  if (out.refined.stopped) out.run.state = {Stage::kInterrupted, "", 0, "stopped by request", true};
  out.run.metrics.state = out.run.state.word();
  out.refined.gaussians.clear();
  out.refined.harmonics = {};
  save_run(out.run, folder);
  folder.end(out.run.state.stage, out.run.frames.size(), out.run.state.reason);
  return out;
}

void save_refine_parameters(const std::string& source, const RefineOptions& options,
                            RunFolder& folder) {
  refine::RefineConfig config = options.config;
  ParameterList list;
  list.add_group("refine", config);
  const refine::Budget& budget = options.budget;
  folder.save_text(files::kRefine,
                   fmt::format("# {} refined with --{}; every value as used.\n{}", source,
                               budget.steps > 0 ? fmt::format("steps {}", budget.steps)
                                                : fmt::format("minutes {:g}", budget.seconds / 60),
                               list.to_toml()));
}

fs::path refined_folder_of(const fs::path& source) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(source, error);
  const std::string base = whole.parent_path() / (whole.stem().string() + "-refined");
  fs::path path = base;
  for (int i = 2; fs::exists(path, error); ++i) path = fmt::format("{}-{}", base, i);
  return path;
}

}  // namespace sgs::run
