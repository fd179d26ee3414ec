// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sgs/alignment/known_view.h"
#include "sgs/graph/pose_graph.h"
#include "sgs/map/gaussian.h"
#include "sgs/mapfile/chunk_file.h"

namespace sgs::mapfile {

/// Its name in a run folder.
inline constexpr const char* kFileName = "map.sgsmap";
/// Side of the cubes that Gaussians lie in.
inline constexpr double kCube_m = 4;

/// One time that a camera was there.
struct MapSession {
  std::string name;      ///< of the recording
  std::string version;   ///< of sgs
  PinholeCamera camera;  ///< of its frames as they were tracked
  double first_s = 0, last_s = 0;
  std::int64_t frames = 0;
  std::string calibration;  ///< of its depths, as calibration.toml has it; empty = none

  template <class Archive>
  void archive(Archive& a);
};

/// The Gaussians of a map, and when each was born.
struct MapGaussians {
  map::SplatMap splats;
  std::vector<std::uint16_t> born_in;  ///< number of the session
  std::vector<double> born_s;          ///< time in it; not a number where that is not known
};

/// How the views of a map hang together.
struct MapGraph {
  std::vector<std::uint16_t> session;  ///< of each view; those of a session follow each other
  /// From where the Gaussians look like each view: its pose as the mapper has refined it.
  std::vector<SE3> T_map_camera;
  /// Between views, by their numbers: first the way from each view to the next, then loops.
  std::vector<graph::Edge> edges;
};

/// What a map file is made of. Views are asked for one by one, so that they need not be in memory
/// together.
struct MapContents {
  std::vector<MapSession> sessions;
  MapGaussians gaussians;
  std::size_t views = 0;
  std::function<alignment::KnownView(std::size_t)> view;
  MapGraph graph;
};

/// Replaces `path` in one step.
Status save_map(const std::filesystem::path& path, const MapContents& contents);

/// A map that a run has left, for others to come back to (docs/maps.md). Immutable.
class MapFile {
 public:
  /// `path`: the file, or the run folder that it lies in. Every byte is checked; what is no map, of
  /// a later format, cut off or damaged is refused by name.
  static Result<MapFile> open(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return file_.path(); }
  const ChunkFile& file() const { return file_; }
  const std::vector<MapSession>& sessions() const { return sessions_; }
  Result<MapGaussians> gaussians() const;
  std::size_t views() const { return views_.size(); }
  Result<alignment::KnownView> view(std::size_t number) const;
  /// Of maps from before it was kept: all views of session 0, no refined poses and no edges.
  Result<MapGraph> graph() const;

 private:
  ChunkFile file_;
  std::vector<MapSession> sessions_;
  std::vector<Chunk> views_;
};

/// Whether `path` is a file that is called like a map.
bool looks_like_map(const std::filesystem::path& path);

}  // namespace sgs::mapfile
