// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "info_map.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "camera_json.h"
#include "commands.h"
#include "sgs/core/print.h"
#include "sgs/mapfile/map_file.h"

namespace sgs::app {
namespace {

/// What is told of a map.
struct MapSummary {
  std::uint64_t bytes = 0, gaussian_bytes = 0, view_bytes = 0;
  std::size_t cubes = 0, gaussians = 0, views = 0;
  Eigen::AlignedBox3d bounds;  ///< of the centres
  std::vector<mapfile::MapSession> sessions;
  std::vector<std::size_t> born, seen;  ///< Gaussians and views of each session
};

Result<MapSummary> summarise(const mapfile::MapFile& map) {
  MapSummary out;
  out.bytes = map.file().bytes();
  out.views = map.views();
  out.sessions = map.sessions();
  for (const mapfile::Chunk& chunk : map.file().chunks()) {
    if (chunk.kind == mapfile::ChunkKind::kView) out.view_bytes += chunk.packed;
    if (chunk.kind != mapfile::ChunkKind::kGaussians) continue;
    out.gaussian_bytes += chunk.packed;
    ++out.cubes;
  }
  SGS_ASSIGN_OR_RETURN(const auto gaussians, map.gaussians());
  SGS_ASSIGN_OR_RETURN(const auto graph, map.graph());
  const auto counted = [&](const std::vector<std::uint16_t>& sessions) {
    std::vector<std::size_t> counts(out.sessions.size(), 0);
    for (const std::uint16_t s : sessions) {
      if (s < counts.size()) ++counts[s];
    }
    return counts;
  };
  out.born = counted(gaussians.born_in);
  out.seen = counted(graph.session);
  out.gaussians = gaussians.splats.gaussians.size();
  for (const map::Gaussian& g : gaussians.splats.gaussians) {
    out.bounds.extend(Eigen::Map<const Eigen::Vector3f>(g.mean).cast<double>());
  }
  return out;
}

std::vector<double> listed(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Where the views were taken, in the map's world.
Result<nlohmann::json> places_of(const mapfile::MapFile& map) {
  nlohmann::json places = nlohmann::json::array();
  SGS_ASSIGN_OR_RETURN(const auto graph, map.graph());
  for (std::size_t i = 0; i < map.views(); ++i) {
    SGS_ASSIGN_OR_RETURN(const auto view, map.view(i));
    const Eigen::Vector3d& t = view.T_world_camera.t;
    const Eigen::Quaterniond q = view.T_world_camera.quaternion();
    places.push_back({{"session", graph.session[i]},
                      {"time_s", view.timestamp_s},
                      {"pose", {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}}});
  }
  return places;
}

void print_json(const MapSummary& m, nlohmann::json places) {
  nlohmann::json sessions = nlohmann::json::array();
  for (std::size_t i = 0; i < m.sessions.size(); ++i) {
    const mapfile::MapSession& s = m.sessions[i];
    nlohmann::json session = {
        {"gaussians", m.born[i]},  {"views", m.seen[i]},
        {"name", s.name},          {"version", s.version},
        {"frames", s.frames},      {"first_time_s", s.first_s},
        {"last_time_s", s.last_s}, {"depth_calibrated", !s.calibration.empty()}};
    session.update(camera_json(s.camera));
    sessions.push_back(std::move(session));
  }
  nlohmann::json json = {
      {"format", mapfile::kFormat},         {"bytes", m.bytes},     {"gaussians", m.gaussians},
      {"gaussian_bytes", m.gaussian_bytes}, {"cubes", m.cubes},     {"views", m.views},
      {"view_bytes", m.view_bytes},         {"sessions", sessions}, {"places", std::move(places)}};
  if (!m.bounds.isEmpty()) {
    json["bounds_m"] = {{"min", listed(m.bounds.min())}, {"max", listed(m.bounds.max())}};
  }
  print("{}\n", json.dump(2));
}

void print_text(const std::string& path, const MapSummary& m) {
  constexpr double kMegabyte = 1e6;
  print("map          {}, format {}, {:.1f} MB\n", path, mapfile::kFormat,
        static_cast<double>(m.bytes) / kMegabyte);
  print("gaussians    {} in {} cubes of {} m, {:.1f} MB\n", m.gaussians, m.cubes, mapfile::kCube_m,
        static_cast<double>(m.gaussian_bytes) / kMegabyte);
  print("views        {}, {:.1f} MB\n", m.views, static_cast<double>(m.view_bytes) / kMegabyte);
  if (!m.bounds.isEmpty()) {
    const Eigen::Vector3d &a = m.bounds.min(), &b = m.bounds.max();
    print("bounds       x {:.2f} to {:.2f} m, y {:.2f} to {:.2f} m, z {:.2f} to {:.2f} m\n", a.x(),
          b.x(), a.y(), b.y(), a.z(), b.z());
  }
  for (std::size_t i = 0; i < m.sessions.size(); ++i) {
    const mapfile::MapSession& s = m.sessions[i];
    print(
        "session {}    {}: {} frames, {:.3f} to {:.3f} s, camera {}x{} fx {:.6g} fy {:.6g}, depth "
        "{}, sgs {}; {} Gaussians, {} views\n",
        i, s.name, s.frames, s.first_s, s.last_s, s.camera.width, s.camera.height, s.camera.fx,
        s.camera.fy, s.calibration.empty() ? "as measured" : "calibrated", s.version, m.born[i],
        m.seen[i]);
  }
}

}  // namespace

int print_map(const std::string& path, bool json) {
  const auto map = mapfile::MapFile::open(path);
  if (!map) return report(map.error());
  const auto summary = summarise(*map);
  if (!summary) return report(summary.error());
  if (json) {
    auto places = places_of(*map);
    if (!places) return report(places.error());
    print_json(*summary, std::move(*places));
  } else {
    print_text(map->path().string(), *summary);
  }
  return kExitDone;
}

}  // namespace sgs::app
