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
#include "sgs/map/gaussian.h"
#include "sgs/run/input.h"
#include "sgs/run/run_folder.h"
#include "sgs/slam/frame_record.h"
#include "sgs/slam/session.h"

namespace sgs::run {

/// A finished run: what its folder holds. All that scoring, drawing and exporting need; only
/// comparing pictures needs the recording, too.
struct Run {
  InputSpec input;
  slam::SessionConfig config;
  std::string config_toml;                      ///< as saved
  std::string name;                             ///< of the sequence
  PinholeCamera camera;                         ///< of the frames as they were tracked (rectified)
  std::optional<DepthCalibration> calibration;  ///< of their depths, where one was used
  std::vector<slam::FrameRecord> frames;
  Trajectory trajectory;  ///< estimated, one pose per readable frame
  Trajectory keyframes;   ///< of the mapper, refined
  Trajectory truth;       ///< empty where there is none
  std::vector<map::Gaussian> gaussians;
  std::string timings_json;       ///< "" where it is not known
  std::int64_t frames_total = 0;  ///< of the sequence, bad and dropped ones included
  eval::Metrics metrics;          ///< what the run measured of itself, and scores where it has them
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
/// of a folder from before it was kept comes from the recording.
Result<Run> load_run(const std::filesystem::path& folder, unsigned parts);

/// The run of a session that is finished, without scores. `input` and `config` are what it was
/// made with.
Run run_of(const slam::Session& session, const Input& input, const InputSpec& spec,
           const slam::SessionConfig& config);

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
map::SnapshotPtr as_snapshot(std::vector<map::Gaussian> gaussians);

}  // namespace sgs::run
