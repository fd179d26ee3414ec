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
  out.gaussians = gaussians.splats.gaussians.size();
  for (const map::Gaussian& g : gaussians.splats.gaussians) {
    out.bounds.extend(Eigen::Map<const Eigen::Vector3f>(g.mean).cast<double>());
  }
  return out;
}

std::vector<double> listed(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void print_json(const MapSummary& m) {
  nlohmann::json sessions = nlohmann::json::array();
  for (const auto& s : m.sessions) {
    nlohmann::json session = {
        {"name", s.name},          {"version", s.version},
        {"frames", s.frames},      {"first_time_s", s.first_s},
        {"last_time_s", s.last_s}, {"depth_calibrated", !s.calibration.empty()}};
    session.update(camera_json(s.camera));
    sessions.push_back(std::move(session));
  }
  nlohmann::json json = {{"format", mapfile::kFormat}, {"bytes", m.bytes},
                         {"gaussians", m.gaussians},   {"gaussian_bytes", m.gaussian_bytes},
                         {"cubes", m.cubes},           {"views", m.views},
                         {"view_bytes", m.view_bytes}, {"sessions", sessions}};
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
        "{}, sgs {}\n",
        i, s.name, s.frames, s.first_s, s.last_s, s.camera.width, s.camera.height, s.camera.fx,
        s.camera.fy, s.calibration.empty() ? "as measured" : "calibrated", s.version);
  }
}

}  // namespace

int print_map(const std::string& path, bool json) {
  const auto map = mapfile::MapFile::open(path);
  if (!map) return report(map.error());
  const auto summary = summarise(*map);
  if (!summary) return report(summary.error());
  if (json) {
    print_json(*summary);
  } else {
    print_text(map->path().string(), *summary);
  }
  return kExitDone;
}

}  // namespace sgs::app
