// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/lasting_map.h"

#include <fmt/format.h>

#include "sgs/core/log.h"
#include "sgs/io/depth_calibration_io.h"
#include "sgs/mapfile/map_file.h"
#include "sgs/runfolder/version.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;

mapfile::MapSession session_of(const Run& run) {
  mapfile::MapSession out;
  out.name = run.name;
  out.version = version();
  out.camera = run.camera;
  if (!run.frames.empty()) {
    out.first_s = run.frames.front().timestamp_s;
    out.last_s = run.frames.back().timestamp_s;
  }
  out.frames = static_cast<std::int64_t>(run.frames.size());
  if (run.calibration) out.calibration = io::depth_calibration_text(*run.calibration);
  return out;
}

}  // namespace

Status save_lasting_map(const fs::path& path, const slam::Session& session, const Run& run,
                        int threads) {
  mapfile::MapContents contents;
  contents.sessions = {session_of(run)};
  mapfile::MapGaussians& gaussians = contents.gaussians;
  if (const auto snapshot = session.final_snapshot()) {
    gaussians.splats = {snapshot->gaussians, snapshot->harmonics};
    gaussians.born_s = slam::births_of(session, *snapshot);
    gaussians.born_in.assign(gaussians.born_s.size(), 0);
  }
  contents.views = slam::known_views(session);
  ThreadPool pool(threads);
  const std::vector<SE3> poses = slam::agreeing_poses(session, run.trajectory, pool);
  contents.view = [&](std::size_t number) {
    tracker::KnownView view = slam::known_view(session, run.trajectory, number);
    view.T_world_camera = poses[number];
    return view;
  };
  return mapfile::save_map(path, contents);
}

Status localise(slam::Session& session, const fs::path& map, const PinholeCamera& camera,
                bool calibrated) {
  SGS_ASSIGN_OR_RETURN(const auto file, mapfile::MapFile::open(map));
  if (file.views() == 0) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} holds no views that a camera could find itself by", file.path().string()),
        "make it with a tracker that closes loops (loops.enabled), as the default does");
  }
  slam::KnownMap known;
  {
    SGS_ASSIGN_OR_RETURN(auto gaussians, file.gaussians());
    known.gaussians = as_snapshot(std::move(gaussians.splats));
  }
  known.views = file.views();
  known.view = [&file](std::size_t number) { return file.view(number); };
  const mapfile::MapSession& newest = file.sessions().back();
  if (!calibrated && !newest.calibration.empty() && newest.camera == camera) {
    SGS_ASSIGN_OR_RETURN(known.calibration,
                         io::depth_calibration_from_text(newest.calibration, file.path().string()));
  }
  SGS_RETURN_IF_ERROR(session.localise_in(known));
  log().info("the camera is looked for in {}: {} Gaussians, {} views", file.path().string(),
             known.gaussians->gaussians.size(), known.views);
  return {};
}

std::string not_found_sentence(const tracker::PlaceSearch& search, const std::string& map) {
  std::string out = fmt::format("the camera has not found itself in {}", map);
  if (search.looks == 0) return out + ": no frame shows enough to be compared with it";
  out += fmt::format(
      ": best candidate {} of {} features that agree ({} alike; frame at {:.3f} s, "
      "view of the map at {:.3f} s)",
      search.best_inliers, search.needed_inliers, search.best_matches, search.best_frame_s,
      search.best_view_s);
  if (search.refused > 0) {
    out += fmt::format("; {} candidates were refused by surfaces or pictures", search.refused);
  }
  return out;
}

}  // namespace sgs::run
