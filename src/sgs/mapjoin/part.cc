// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/part.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/slam/known_map.h"

namespace sgs::mapjoin {

Result<Part> load_part(const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(auto opened, mapfile::MapFile::open(path));
  const auto file = std::make_shared<const mapfile::MapFile>(std::move(opened));
  if (file->views() == 0) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} holds no views by which it could be joined", file->path().string()),
                "make it with a tracker that closes loops (loops.enabled), as the default does");
  }
  Part part;
  part.sessions = file->sessions();
  SGS_ASSIGN_OR_RETURN(part.gaussians, file->gaussians());
  if (!part.gaussians.splats.harmonics.empty()) {
    log().warn("{}: colours that depend on where one looks from are left out",
               file->path().string());
    part.gaussians.splats.harmonics = {};
  }
  SGS_ASSIGN_OR_RETURN(part.graph, file->graph());
  for (std::size_t i = 0; i < file->views(); ++i) {
    SGS_ASSIGN_OR_RETURN(const alignment::KnownView view, file->view(i));
    part.times_s.push_back(view.timestamp_s);
    part.T_world_camera.push_back(view.T_world_camera);
  }
  if (part.graph.T_map_camera.empty()) part.graph.T_map_camera = part.T_world_camera;
  // It could be read a moment ago, and is in memory since.
  part.view = [file](std::size_t number) { return *file->view(number); };
  return part;
}

void place_views(Part& part, std::vector<SE3> T_world_camera) {
  part.T_world_camera = std::move(T_world_camera);
  part.view = [view = std::move(part.view), poses = part.T_world_camera](std::size_t number) {
    alignment::KnownView out = view(number);
    out.T_world_camera = poses[number];
    return out;
  };
}

Part side_by_side(const Part& base, const Part& other) {
  Part out = base;
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  const auto sessions = static_cast<std::uint16_t>(base.sessions.size());
  const auto views = static_cast<int>(base.views());
  add(out.sessions, other.sessions);
  add(out.gaussians.splats.gaussians, other.gaussians.splats.gaussians);
  add(out.gaussians.born_s, other.gaussians.born_s);
  for (const std::uint16_t s : other.gaussians.born_in) {
    out.gaussians.born_in.push_back(static_cast<std::uint16_t>(s + sessions));
  }
  for (const std::uint16_t s : other.graph.session) {
    out.graph.session.push_back(static_cast<std::uint16_t>(s + sessions));
  }
  add(out.graph.T_map_camera, other.graph.T_map_camera);
  for (graph::Edge edge : other.graph.edges) {
    edge.from += views;
    edge.to += views;
    out.graph.edges.push_back(edge);
  }
  add(out.times_s, other.times_s);
  add(out.T_world_camera, other.T_world_camera);
  out.view = [a = base.view, b = other.view, first = base.views()](std::size_t number) {
    return number < first ? a(number) : b(number - first);
  };
  return out;
}

std::vector<std::int32_t> views_of_gaussians(const Part& part) {
  slam::KnownMap map;
  map.sessions = static_cast<std::uint16_t>(part.sessions.size());
  map.session_of = part.graph.session;
  for (std::size_t i = 0; i < part.gaussians.born_s.size(); ++i) {
    map.births.push_back({part.gaussians.born_in[i], part.gaussians.born_s[i]});
  }
  return slam::views_of_gaussians(map, part.times_s);
}

}  // namespace sgs::mapjoin
