// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/lasting_map.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/io/depth_calibration_io.h"
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
                        std::vector<mapfile::MapSession> earlier, int threads) {
  mapfile::MapContents contents;
  contents.sessions = std::move(earlier);
  contents.sessions.push_back(session_of(run));
  mapfile::MapGaussians& gaussians = contents.gaussians;
  if (const auto snapshot = session.final_snapshot()) {
    gaussians.splats = {snapshot->gaussians, snapshot->harmonics};
    for (const slam::Birth& birth : slam::births_of(session, *snapshot)) {
      gaussians.born_in.push_back(birth.session);
      gaussians.born_s.push_back(birth.time_s);
    }
  }
  contents.views = slam::known_views(session);
  ThreadPool pool(threads);
  const std::vector<SE3> poses = slam::agreeing_poses(session, run.trajectory, pool);
  contents.view = [&](std::size_t number) {
    alignment::KnownView view = slam::known_view(session, run.trajectory, number);
    view.T_world_camera = poses[number];
    return view;
  };
  contents.graph = {slam::sessions_of_views(session), slam::places_in_map(session),
                    slam::edges_of_views(session, poses)};
  return mapfile::save_map(path, contents);
}

namespace {

/// All that a session is told of a map.
Result<slam::KnownMap> known_map_of(const mapfile::MapFile& file) {
  slam::KnownMap known;
  SGS_ASSIGN_OR_RETURN(auto gaussians, file.gaussians());
  for (std::size_t i = 0; i < gaussians.born_s.size(); ++i) {
    known.births.push_back({gaussians.born_in[i], gaussians.born_s[i]});
  }
  known.gaussians = as_snapshot(std::move(gaussians.splats));
  known.views = file.views();
  known.view = [&file](std::size_t number) { return file.view(number); };
  known.sessions = static_cast<std::uint16_t>(file.sessions().size());
  SGS_ASSIGN_OR_RETURN(auto graph, file.graph());
  known.session_of = std::move(graph.session);
  known.T_map_camera = std::move(graph.T_map_camera);
  known.edges = std::move(graph.edges);
  return known;
}

}  // namespace

Result<std::vector<mapfile::MapSession>> give_map(slam::Session& session, const InputSpec& spec,
                                                  const PinholeCamera& camera, bool calibrated) {
  SGS_ASSIGN_OR_RETURN(const auto file, mapfile::MapFile::open(spec.map));
  if (file.views() == 0) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} holds no views that a camera could find itself by", file.path().string()),
        "make it with a tracker that closes loops (loops.enabled), as the default does");
  }
  SGS_ASSIGN_OR_RETURN(slam::KnownMap known, known_map_of(file));
  const mapfile::MapSession& newest = file.sessions().back();
  if (!calibrated && !newest.calibration.empty() && newest.camera == camera) {
    SGS_ASSIGN_OR_RETURN(known.calibration,
                         io::depth_calibration_from_text(newest.calibration, file.path().string()));
  }
  if (spec.extends_map && !known.gaussians->harmonics.empty()) {
    log().warn("{}: colours that depend on where one looks from are not gone on with",
               file.path().string());
  }
  SGS_RETURN_IF_ERROR(spec.extends_map ? session.go_on_with(known) : session.localise_in(known));
  log().info("the camera is looked for in {}: {} Gaussians, {} views", file.path().string(),
             known.gaussians->gaussians.size(), known.views);
  return file.sessions();
}

std::string not_found_sentence(const tracker::PlaceSearch& search, const std::string& map) {
  std::string out = fmt::format("the camera has not found itself in {}", map);
  if (search.looks == 0) return out + ": no frame shows enough to be compared with it";
  const std::string view = std::isnan(search.best_view_s)
                               ? "a view of it from where no camera was"
                               : fmt::format("view of the map at {:.3f} s", search.best_view_s);
  out += fmt::format(
      ": best candidate {} of {} features that agree ({} alike; frame at {:.3f} s, {})",
      search.best_inliers, search.needed_inliers, search.best_matches, search.best_frame_s, view);
  if (search.refused > 0) {
    out += fmt::format("; {} candidates were refused by surfaces or pictures", search.refused);
  }
  return out;
}

}  // namespace sgs::run
