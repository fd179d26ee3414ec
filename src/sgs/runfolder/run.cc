// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/io/append_file.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/calibration_io.h"
#include "sgs/io/csv.h"
#include "sgs/io/depth_calibration_io.h"
#include "sgs/io/image_io.h"
#include "sgs/io/ply.h"
#include "sgs/io/text.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/runfolder/checkpoint_folders.h"
#include "sgs/runfolder/journal.h"
#include "sgs/runfolder/movers_file.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/runfolder/run_files.h"
#include "sgs/runfolder/timings.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;

constexpr double kDepthScale = 5000;  // of no meaning here: camera.txt asks for one

Status load_poses(const fs::path& path, Trajectory& poses) {
  SGS_ASSIGN_OR_RETURN(auto loaded, io::load_trajectory(path));
  poses = std::move(loaded.trajectory);
  return {};
}

/// Tracked poses carried into the map whose keyframes these are.
Trajectory corrected(const Trajectory& online, const Trajectory& keyframes) {
  std::vector<MovedPose> known;
  for (const StampedPose& refined : keyframes.poses()) {
    const auto tracked = online.at(refined.timestamp_s, 0.0);
    if (tracked) known.push_back({refined.timestamp_s, *tracked, refined.T_world_camera});
  }
  const PoseCorrection to_map(std::move(known));
  std::vector<StampedPose> poses = online.poses();
  for (StampedPose& pose : poses) {
    pose.T_world_camera = to_map.corrected(pose.T_world_camera, pose.timestamp_s);
  }
  return Trajectory(std::move(poses));
}

/// trajectory.txt, also where it is still a journal; `checkpoint` is the folder of its map then.
Result<Trajectory> load_trajectory_of(const fs::path& path, const fs::path& checkpoint) {
  SGS_ASSIGN_OR_RETURN(const auto text, io::read_file(path));
  const bool online = text.starts_with(kOnlinePoses);
  SGS_ASSIGN_OR_RETURN(auto loaded,
                       io::trajectory_from_text(online ? io::whole_lines(text) : text, path));
  if (!online) return std::move(loaded.trajectory);
  const fs::path keyframes = checkpoint / files::kKeyframes;
  std::error_code unreadable;
  Trajectory refined;
  if (fs::exists(keyframes, unreadable)) SGS_RETURN_IF_ERROR(load_poses(keyframes, refined));
  return corrected(loaded.trajectory, refined);
}

/// Folders from before the camera was kept know only where it came from.
Status load_camera(const fs::path& path, Run& run) {
  std::error_code error;
  if (fs::exists(path, error)) {
    SGS_ASSIGN_OR_RETURN(const auto calibration, io::load_camera_txt(path));
    run.camera = calibration.camera;
    return {};
  }
  const auto input = reopen_input(run.input, 1);
  if (!input) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{} is missing, and its recording cannot be opened: {}", path.string(),
                            input.error().message),
                "write a line `fx fy cx cy width height 5000` to that file, or bring the recording "
                "back");
  }
  run.camera = input->source->camera();
  return {};
}

/// A part of a run folder: its file, how to read it, and what can be done without it. `checkpoint`
/// is where those of an unfinished run lie that belong to its map.
struct PartFile {
  Part part;
  const char* name;
  Status (*load)(const fs::path& path, const fs::path& checkpoint, Run& run);
  const char* without;
  bool of_checkpoint = false;
};

const std::array<PartFile, 6> kPartFiles = {{
    {kCamera, files::kCamera,
     [](const fs::path& path, const fs::path&, Run& run) { return load_camera(path, run); },
     "`sgs eval --compare` and `sgs export RUN ply` do without the camera"},
    {kTrajectory, files::kTrajectory,
     [](const fs::path& path, const fs::path& checkpoint, Run& run) -> Status {
       SGS_ASSIGN_OR_RETURN(run.trajectory, load_trajectory_of(path, checkpoint));
       // Runs without one are scored without it.
       const fs::path online = path.parent_path() / files::kOnline;
       std::error_code unreadable;
       return fs::exists(online, unreadable) ? load_poses(online, run.online) : Status{};
     },
     "`sgs export RUN ply` does without poses"},
    {kKeyframes, files::kKeyframes,
     [](const fs::path& path, const fs::path&, Run& run) {
       return load_poses(path, run.keyframes);
     },
     "`sgs render`, `sgs view` and `sgs export RUN ply` do without keyframes", true},
    {kTruth, files::kTruth,
     [](const fs::path& path, const fs::path&, Run& run) { return load_poses(path, run.truth); },
     "`sgs render`, `sgs view` and `sgs export` do without ground truth"},
    {kFrames, files::kFrames,
     [](const fs::path& path, const fs::path&, Run& run) -> Status {
       SGS_ASSIGN_OR_RETURN(const auto text, io::read_file(path));
       const std::string_view lines = run.state.unfinished() ? io::whole_lines(text) : text;
       SGS_ASSIGN_OR_RETURN(run.frames, slam::frames_from_csv(lines, path.string()));
       // Where nothing moved there is none.
       const fs::path movers = path.parent_path() / files::kMovers;
       std::error_code unreadable;
       return fs::exists(movers, unreadable) ? load_movers(movers, run.frames) : Status{};
     },
     "`sgs render` and `sgs export` do without it"},
    {kMap, files::kMap,
     [](const fs::path& path, const fs::path&, Run& run) -> Status {
       SGS_ASSIGN_OR_RETURN(auto splats, io::load_splats(path));
       run.gaussians = std::move(splats.gaussians);
       run.harmonics = std::move(splats.harmonics);
       return {};
     },
     "`sgs export RUN tum` does without the map", true},
}};

/// Reads a part; one that an unfinished run had not come to yet is empty.
Status load_part(const PartFile& file, const fs::path& folder, const fs::path& checkpoint,
                 Run& run) {
  const fs::path path = (file.of_checkpoint ? checkpoint : folder) / file.name;
  const Status status = file.load(path, checkpoint, run);
  if (status) return {};
  std::error_code unreadable;
  const bool missing = !fs::exists(path, unreadable);
  if (run.state.unfinished() && missing && file.part != kCamera) return {};
  Error problem = status.error();
  problem.remedy += fmt::format("{}{}", problem.remedy.empty() ? "" : "; ", file.without);
  return tl::unexpected(problem);
}

/// What was known of the depth camera: given with the input, or learned and kept beside the map.
Result<std::optional<DepthCalibration>> load_calibration_of(const InputSpec& input,
                                                            const fs::path& map_folder) {
  const fs::path learned = map_folder / files::kCalibration;
  std::error_code unreadable;
  if (input.calibration.empty() && !fs::exists(learned, unreadable)) return std::nullopt;
  return io::load_depth_calibration(input.calibration.empty() ? learned
                                                              : fs::path(input.calibration));
}

/// How the world of a run stands; what cannot be read is no reason not to show it.
std::optional<Upright> load_upright_of(const fs::path& folder) {
  std::error_code unreadable;
  if (!fs::exists(folder / files::kUpright, unreadable)) return std::nullopt;
  auto upright = load_upright(folder / files::kUpright);
  if (upright) return *upright;
  log().warn("{}", upright.error().text());
  return std::nullopt;
}

/// Where the map of a run lies: with the results, or in the last checkpoint.
fs::path folder_of_map(const fs::path& folder, const RunState& state) {
  return state.unfinished() ? newest_checkpoint(folder) : folder;
}

/// Calls `load` with the folder of the map, once more where that was replaced meanwhile.
template <class Load>
auto with_folder_of_map(const fs::path& folder, const RunState& state, const Load& load) {
  constexpr int kAttempts = 5;
  fs::path map_folder = folder_of_map(folder, state);
  auto loaded = load(map_folder);
  std::error_code unreadable;
  for (int i = 1; i < kAttempts && (!loaded || !fs::exists(map_folder, unreadable)); ++i) {
    const fs::path before = std::exchange(map_folder, folder_of_map(folder, state));
    if (before == map_folder) break;
    loaded = load(map_folder);
  }
  return loaded;
}

Status check_has_begun(const fs::path& folder, const RunState& state) {
  std::error_code unreadable;
  if (!state.unfinished() || fs::exists(folder / files::kConfig, unreadable)) return {};
  return fail(ErrorCode::kNotFound,
              fmt::format("the run in {} has not begun: nothing is there yet", folder.string()),
              state.held ? "wait for it" : "it was killed: run it again");
}

fs::path picture_name(std::int64_t index, const char* what) {
  return fmt::format("{:06}_{}.png", index, what);
}

}  // namespace

Result<Run> load_run(const fs::path& folder, unsigned parts) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return fail(ErrorCode::kNotFound, fmt::format("{} is not a folder", folder.string()),
                "give a run folder made by `sgs run`");
  }
  Run run;
  SGS_ASSIGN_OR_RETURN(run.state, load_state(folder));
  SGS_RETURN_IF_ERROR(check_has_begun(folder, run.state));
  SGS_ASSIGN_OR_RETURN(auto saved, load_config(folder));
  run.input = std::move(saved.input);
  run.config = std::move(saved.config.session);
  run.name = fs::path(run.input.input).filename().string();
  SGS_ASSIGN_OR_RETURN(run.config_toml, io::read_file(folder / files::kConfig));
  const auto load_parts = [&](const fs::path& map_folder) -> Status {
    SGS_ASSIGN_OR_RETURN(run.calibration, load_calibration_of(run.input, map_folder));
    for (const PartFile& file : kPartFiles) {
      if ((parts & file.part) != 0) SGS_RETURN_IF_ERROR(load_part(file, folder, map_folder, run));
    }
    return {};
  };
  SGS_RETURN_IF_ERROR(with_folder_of_map(folder, run.state, load_parts));
  if (auto timings = io::read_file(folder / files::kTimings)) run.timings_json = *timings;
  run.upright = load_upright_of(folder);
  if (fs::exists(folder / files::kMetrics, error)) {
    SGS_ASSIGN_OR_RETURN(run.metrics, eval::load_metrics(folder / files::kMetrics));
  }
  run.metrics.seed = static_cast<std::int64_t>(run.config.seed);
  run.metrics.preset = to_string(run.config.preset);
  run.metrics.tracker = to_string(run.config.tracker.type);
  run.metrics.state = run.state.word();
  if (run.upright) run.metrics.upright = to_string(run.upright->by);
  if (run.state.unfinished() && (parts & kMap) != 0) {
    run.metrics.gaussians = static_cast<std::int64_t>(run.gaussians.size());
  }
  // Dropped frames have no line, and what a file claims is no reason to believe in any number.
  const auto rows = static_cast<std::int64_t>(run.frames.size());
  const auto last = run.frames.empty() ? 0 : run.frames.back().index + 1;
  const auto dropped = std::max<std::int64_t>(0, run.metrics.frames_dropped.value_or(0));
  run.frames_total =
      std::clamp(run.metrics.frames.value_or(rows), rows, std::max(last, rows) + dropped);
  return run;
}

Result<Trajectory> load_run_trajectory(const fs::path& folder) {
  SGS_ASSIGN_OR_RETURN(const auto state, load_state(folder));
  return with_folder_of_map(folder, state, [&](const fs::path& map_folder) {
    return load_trajectory_of(folder / files::kTrajectory, map_folder);
  });
}

double learned_depth_delay_s(const Run& run) {
  for (auto record = run.frames.rbegin(); record != run.frames.rend(); ++record) {
    const double delay_s = record->diagnostics.depth_delay_s;
    if (!record->bad && std::isfinite(delay_s)) return delay_s;
  }
  return 0;
}

Result<SE3> load_run_upright(const fs::path& folder) {
  std::error_code unreadable;
  if (!fs::exists(folder / files::kUpright, unreadable)) {
    return fail(
        ErrorCode::kNotFound,
        fmt::format("{}: nothing says which way is up ({})", folder.string(), files::kUpright),
        "give the folder of a run that has ended, made by this version");
  }
  SGS_ASSIGN_OR_RETURN(const Upright upright, load_upright(folder / files::kUpright));
  return upright.T_upright_world;
}

Trajectory view_poses(const Run& run) { return corrected(run.trajectory, run.keyframes); }

Result<map::SplatMap> load_run_map(const fs::path& folder) {
  SGS_ASSIGN_OR_RETURN(const auto state, load_state(folder));
  auto map = with_folder_of_map(folder, state, [](const fs::path& map_folder) {
    return io::load_splats(map_folder / files::kMap);
  });
  if (!map && map.error().code == ErrorCode::kNotFound && state.unfinished()) {
    map.error().remedy = "the run had not come to its first checkpoint of the map";
  }
  return map;
}

Run beginning_of(const Input& input, const InputSpec& spec, const RunConfig& config) {
  Run run;
  run.input = spec;
  run.config = config.session;
  run.config_toml = config_text(spec, config);
  run.name = input.info.name;
  run.camera = input.source->camera();
  run.calibration = input.calibration;
  run.truth = input.source->ground_truth();
  return run;
}

Run run_of(const slam::Session& session, const Input& input, const InputSpec& spec,
           const refine::RefineConfig& refine) {
  Run run = beginning_of(input, spec, {session.config(), refine});
  run.frames = session.records().all();
  run.trajectory = session.trajectory();
  run.online = session.online_trajectory();
  run.keyframes = session.keyframe_trajectory();
  run.frames_total = static_cast<std::int64_t>(run.frames.size());
  if (const auto snapshot = session.final_snapshot()) run.gaussians = snapshot->gaussians;
  if (session.calibration()) run.calibration = session.calibration();
  run.timings_json = timings_json(session.times());
  return run;
}

std::vector<NamedWriter> opening_files(const Run& run) {
  std::vector<NamedWriter> opening;
  opening.push_back({files::kConfig, [text = run.config_toml](const fs::path& path) {
                       return io::write_file(path, text);
                     }});
  opening.push_back({files::kCamera, [camera = run.camera](const fs::path& path) {
                       return io::save_camera_txt(path, {camera, {}, kDepthScale});
                     }});
  opening.push_back({files::kTruth, [truth = run.truth](const fs::path& path) {
                       return io::save_trajectory(path, truth);
                     }});
  if (run.calibration) {
    opening.push_back({files::kCalibration, [used = *run.calibration](const fs::path& path) {
                         return io::save_depth_calibration(path, used);
                       }});
  }
  return opening;
}

void save_run(const Run& run, RunFolder& folder) {
  for (const NamedWriter& file : opening_files(run)) folder.save(file.name, file.write);
  const auto save_poses = [&](const char* name, const Trajectory& poses) {
    folder.save(name, [&](const fs::path& path) { return io::save_trajectory(path, poses); });
  };
  save_poses(files::kTrajectory, run.trajectory);
  save_poses(files::kOnline, run.online);
  save_poses(files::kKeyframes, run.keyframes);
  folder.save_text(files::kFrames, slam::frames_csv(run.frames));
  if (const std::string movers = movers_text(run.frames); !movers.empty()) {
    folder.save_text(files::kMovers, movers);
  }
  folder.save(files::kMap, [&](const fs::path& path) {
    return io::save_splats(path, run.gaussians, run.harmonics);
  });
  folder.save_text(files::kTimings, run.timings_json);
  if (run.upright) {
    folder.save(files::kUpright,
                [&](const fs::path& path) { return save_upright(path, *run.upright); });
  }
}

Status save_run(const Run& run, const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(auto folder, RunFolder::create(path));
  save_run(run, folder);
  folder.end(run.state.stage, run.frames.size(), run.state.reason);
  if (!folder.failures().empty()) return tl::unexpected(folder.failures().front());
  return {};
}

void save_pictures(const std::vector<eval::FramePictures>& pictures, RunFolder& folder) {
  std::string list = "index,heldout,psnr_full_db\n";
  for (const eval::FramePictures& p : pictures) {
    const auto save = [&](const char* what, const ColorImage& image) {
      folder.save(files::kRenders / picture_name(p.index, what),
                  [&](const fs::path& path) { return io::save_color(path, image); });
    };
    save("truth", p.truth);
    save("render", p.rendering);
    save("error", p.error);
    if (!p.before.empty()) save("before", p.before);
    list += fmt::format("{},{:d},{:.6g}\n", p.index, p.heldout, p.psnr_full_db);
  }
  if (!pictures.empty()) folder.save_text(files::kPictures, list);
}

std::vector<eval::FramePictures> load_pictures(const fs::path& folder) {
  std::vector<eval::FramePictures> pictures;
  const auto text = io::read_file(folder / files::kPictures);
  if (!text) return pictures;
  const auto table = io::CsvTable::parse(*text, files::kPictures);
  if (!table || !table->column("psnr_full_db")) return pictures;
  for (std::size_t i = 0; i < table->rows(); ++i) {
    const auto cells = table->row(i);
    const auto number = [&](std::size_t column) {
      return io::parse_double(cells[column]).value_or(-1);
    };
    const auto index = static_cast<std::int64_t>(number(0));
    const auto load = [&](const char* what) {
      return io::load_color(folder / files::kRenders / picture_name(index, what));
    };
    auto truth = load("truth"), rendering = load("render"), error = load("error");
    if (!truth || !rendering || !error) {
      log().warn("a picture of frame {} is missing in {}", index, folder.string());
      continue;
    }
    auto before = load("before");
    pictures.push_back({index, number(1) == 1, number(2), std::move(*truth), std::move(*rendering),
                        std::move(*error), before ? std::move(*before) : ColorImage()});
  }
  return pictures;
}

map::SnapshotPtr as_snapshot(map::SplatMap splats, std::uint64_t version) {
  auto snapshot = std::make_shared<map::Snapshot>();
  snapshot->version = version;
  snapshot->anchors.resize(splats.gaussians.size());
  for (std::size_t i = 0; i < splats.gaussians.size(); ++i) {
    snapshot->anchors[i].id = static_cast<std::uint32_t>(i);
  }
  snapshot->gaussians = std::move(splats.gaussians);
  snapshot->harmonics = std::move(splats.harmonics);
  return snapshot;
}

}  // namespace sgs::run
