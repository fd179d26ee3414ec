// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sgs/camera/depth_calibration.h"
#include "sgs/eval/metrics.h"
#include "sgs/eval/run_evaluator.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/input/input.h"
#include "sgs/map/gaussian.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/runfolder/run_folder.h"
#include "sgs/slam/frame_record.h"
#include "sgs/slam/session.h"
#include "sgs/upright/upright.h"

namespace sgs::run {

/// A run as its folder holds it. All that scoring, drawing and exporting need; only
/// comparing pictures needs the recording, too.
struct Run {
  RunState state;
  InputSpec input;
  slam::SessionConfig config;
  std::string config_toml;                      ///< as saved
  std::string name;                             ///< of the sequence
  PinholeCamera camera;                         ///< of the frames as they were tracked (rectified)
  std::optional<DepthCalibration> calibration;  ///< of their depths, given or learned
  std::vector<slam::FrameRecord> frames;
  Trajectory trajectory;  ///< estimated, one pose per readable frame
  Trajectory online;      ///< the same as it was said frame by frame; may be empty
  Trajectory keyframes;   ///< of the mapper, refined
  Trajectory truth;       ///< empty where there is none
  std::vector<map::Gaussian> gaussians;
  map::Harmonics harmonics;        ///< of those; none unless they were learnt (`sgs refine`)
  std::optional<Upright> upright;  ///< which way is up; empty where nobody found out
  std::string timings_json;        ///< "" where it is not known
  std::int64_t frames_total = 0;   ///< of the sequence, bad and dropped ones included
  eval::Metrics metrics;  ///< what the run measured of itself, and scores where it has them
};

/// The parts of a run folder that a command may need; a set of them is a sum.
enum Part : unsigned {
  kNoParts = 0,
  kCamera = 1,
  kTrajectory = 2,
  kKeyframes = 4,
  kTruth = 8,
  kFrames = 16,
  kMap = 32,
};
inline constexpr unsigned kAllParts = 63;

/// Reads the configuration, the parts asked for, and what there is of timings and scores. A part
/// that is missing or damaged is an error that names the file and what works without it. The camera
/// of a folder from before it was kept comes from the recording. Of a run that was killed or is
/// still going on, what is there is read: `state` says so, and parts that it had not come to yet
/// are empty.
Result<Run> load_run(const std::filesystem::path& folder, unsigned parts);

/// The poses of a run folder, in the world of its map. Of an unfinished run they are made from the
/// tracked poses and the keyframes of the last checkpoint.
Result<Trajectory> load_run_trajectory(const std::filesystem::path& folder);
/// Poses from which the map looks like the frames: the trajectory carried into the refined map, by
/// the keyframes before and after (their poses absorb what the pictures and the poses disagree on).
Trajectory view_poses(const Run& run);
/// By how much later than its stamps say depth was measured, as the run held it to be in the end,
/// calibration included; 0 where it never did.
double learned_depth_delay_s(const Run& run);
/// The rotation that turns the world of a run folder upright (upright/upright.h); an error where
/// the folder does not say which way is up.
Result<SE3> load_run_upright(const std::filesystem::path& folder);
/// The map of a run folder; that of an unfinished run is its last checkpoint.
Result<map::SplatMap> load_run_map(const std::filesystem::path& folder);

/// What is known of a run before its first frame.
Run beginning_of(const Input& input, const InputSpec& spec, const RunConfig& config);

/// The run of a session that is finished, without scores. `input` and `spec` are what it was fed
/// from; its configuration is the session's own.
Run run_of(const slam::Session& session, const Input& input, const InputSpec& spec,
           const refine::RefineConfig& refine = {});

/// The files that are known before the first frame: configuration, camera, calibration, truth.
std::vector<NamedWriter> opening_files(const Run& run);

/// Writes what was computed: everything but scores, pictures and the report. Failures are kept in
/// the folder, none keeps the others from being written.
void save_run(const Run& run, RunFolder& folder);
/// The same for users of the library: creates the folder `path`; the first failure is returned.
Status save_run(const Run& run, const std::filesystem::path& path);

/// The pictures kept for the report, in and out of the folder's renders/.
void save_pictures(const std::vector<eval::FramePictures>& pictures, RunFolder& folder);
/// Empty where the folder has none.
std::vector<eval::FramePictures> load_pictures(const std::filesystem::path& folder);

/// The snapshot that consists of a run's map.
map::SnapshotPtr as_snapshot(map::SplatMap splats, std::uint64_t version = 1);

}  // namespace sgs::run
