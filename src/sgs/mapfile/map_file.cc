// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapfile/map_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "sgs/core/archive.h"
#include "sgs/geometry/archive_se3.h"
#include "sgs/mapfile/archive_camera.h"
#include "sgs/mapfile/view_bytes.h"

namespace sgs::mapfile {
namespace {

namespace fs = std::filesystem;

using Cube = std::array<std::int32_t, 3>;

template <class Vector>
Cube cube_of(const Vector& point) {
  constexpr double kFarthest = 1e9;  // cubes: what lies beyond is not a place
  Cube cube;
  for (int i = 0; i < 3; ++i) {
    const double c = std::floor(static_cast<double>(point[i]) / kCube_m);
    cube[static_cast<std::size_t>(i)] =
        c >= -kFarthest && c <= kFarthest ? static_cast<std::int32_t>(c) : 0;
  }
  return cube;
}

/// The numbers of a Gaussian in the order of the file.
constexpr std::size_t kNumbers = 14;
std::array<float*, kNumbers> numbers_of(map::Gaussian& g) {
  return {&g.mean[0],       &g.mean[1],     &g.mean[2],     &g.log_scale[0], &g.log_scale[1],
          &g.log_scale[2],  &g.rotation[0], &g.rotation[1], &g.rotation[2],  &g.rotation[3],
          &g.opacity_logit, &g.rgb[0],      &g.rgb[1],      &g.rgb[2]};
}

/// The Gaussians of a cube as columns: what is alike lies together.
struct Columns {
  std::array<std::vector<float>, kNumbers> numbers;
  std::vector<std::uint16_t> born_in;
  std::vector<double> born_s;
  std::int32_t harmonic_degree = 0;
  std::vector<float> harmonics;

  std::size_t size() const { return born_s.size(); }
  template <class Archive>
  void archive(Archive& a) {
    a(numbers, born_in, born_s, harmonic_degree, harmonics);
  }
  bool consistent() const {
    if (harmonic_degree < 0 || harmonic_degree > map::kMaxHarmonicDegree) return false;
    const map::Harmonics h{harmonic_degree, {}};
    return born_in.size() == size() && harmonics.size() == size() * h.floats() &&
           std::all_of(numbers.begin(), numbers.end(),
                       [&](const auto& column) { return column.size() == size(); });
  }
};

Columns columns_of(const MapGaussians& all, const std::vector<std::size_t>& members) {
  Columns out;
  const map::Harmonics& harmonics = all.splats.harmonics;
  out.harmonic_degree = harmonics.degree;
  for (const std::size_t i : members) {
    map::Gaussian g = all.splats.gaussians[i];
    const auto numbers = numbers_of(g);
    for (std::size_t k = 0; k < kNumbers; ++k) out.numbers[k].push_back(*numbers[k]);
    out.born_in.push_back(all.born_in[i]);
    out.born_s.push_back(all.born_s[i]);
    if (harmonics.empty()) continue;
    const auto of = harmonics.of(i);
    out.harmonics.insert(out.harmonics.end(), of.begin(), of.end());
  }
  return out;
}

void append(const Columns& columns, MapGaussians& all) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    map::Gaussian& g = all.splats.gaussians.emplace_back();
    const auto numbers = numbers_of(g);
    for (std::size_t k = 0; k < kNumbers; ++k) *numbers[k] = columns.numbers[k][i];
  }
  all.born_in.insert(all.born_in.end(), columns.born_in.begin(), columns.born_in.end());
  all.born_s.insert(all.born_s.end(), columns.born_s.begin(), columns.born_s.end());
  auto& coefficients = all.splats.harmonics.coefficients;
  coefficients.insert(coefficients.end(), columns.harmonics.begin(), columns.harmonics.end());
}

/// A graph as fields of an archive.
struct Links {
  MapGraph graph;

  Links() = default;
  explicit Links(const MapGraph& g) : graph(g) {}
  template <class Archive>
  void archive(Archive& a) {
    std::uint64_t count = graph.edges.size();
    a(graph.session, graph.T_map_camera, count);
    for (std::uint64_t i = 0; i < count; ++i) {
      if constexpr (Archive::kReads) {
        if (a.failed()) return;
        graph.edges.emplace_back();
      }
      graph::Edge& e = graph.edges[static_cast<std::size_t>(i)];
      a(e.from, e.to, e.T_from_to, e.information, e.doubtful);
    }
  }
  /// Whether it can be that of so many views and sessions.
  bool consistent(std::size_t views, std::size_t sessions) const {
    const auto is_view = [&](int k) { return k >= 0 && static_cast<std::size_t>(k) < views; };
    return graph.session.size() == views && graph.T_map_camera.size() == views &&
           std::all_of(graph.T_map_camera.begin(), graph.T_map_camera.end(),
                       [](const SE3& T) { return T.all_finite(); }) &&
           std::is_sorted(graph.session.begin(), graph.session.end()) &&
           (views == 0 || graph.session.back() < sessions) &&
           std::all_of(graph.edges.begin(), graph.edges.end(), [&](const graph::Edge& e) {
             return is_view(e.from) && is_view(e.to) && e.from != e.to &&
                    e.T_from_to.all_finite() && e.information.allFinite();
           });
  }
};

/// The chunks of a map, one after the other.
class Chunks {
 public:
  explicit Chunks(const MapContents& contents) : contents_(contents) {
    const auto& gaussians = contents.gaussians.splats.gaussians;
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
      cubes_[cube_of(gaussians[i].mean)].push_back(i);
    }
    cube_ = cubes_.begin();
  }

  std::optional<ChunkContent> next() {
    if (!std::exchange(head_written_, true)) return head();
    if (cube_ != cubes_.end()) {
      const auto& [cube, members] = *cube_++;
      Columns columns = columns_of(contents_.gaussians, members);
      return ChunkContent{ChunkKind::kGaussians, cube, members.size(), bytes_of(columns)};
    }
    if (view_ < contents_.views) {
      const alignment::KnownView view = contents_.view(view_++);
      return ChunkContent{ChunkKind::kView, cube_of(view.T_world_camera.t), 1, view_bytes(view)};
    }
    if (!std::exchange(graph_written_, true)) return graph();
    return std::nullopt;
  }

 private:
  template <class T>
  static std::string bytes_of(T& value) {
    ArchiveWriter archive;
    archive(value);
    return archive.take();
  }
  ChunkContent head() const {
    auto sessions = contents_.sessions;
    return {ChunkKind::kHead, {}, sessions.size(), bytes_of(sessions)};
  }

  ChunkContent graph() const {
    Links links(contents_.graph);
    return {ChunkKind::kGraph, {}, contents_.graph.edges.size(), bytes_of(links)};
  }

  const MapContents& contents_;
  bool head_written_ = false, graph_written_ = false;
  std::map<Cube, std::vector<std::size_t>> cubes_;
  std::map<Cube, std::vector<std::size_t>>::const_iterator cube_;
  std::size_t view_ = 0;
};

}  // namespace

template <class Archive>
void MapSession::archive(Archive& a) {
  a(name, version, camera, first_s, last_s, frames, calibration);
}

Status save_map(const fs::path& path, const MapContents& contents) {
  const std::size_t count = contents.gaussians.splats.gaussians.size();
  SGS_CHECK(contents.gaussians.born_in.size() == count && contents.gaussians.born_s.size() == count,
            "each Gaussian was born");
  SGS_CHECK(contents.graph.session.size() == contents.views &&
                contents.graph.T_map_camera.size() == contents.views,
            "each view is of a session");
  Chunks chunks(contents);
  return write_chunks(path, [&] { return chunks.next(); });
}

Result<MapFile> MapFile::open(const fs::path& path) {
  std::error_code unreadable;
  const bool folder = fs::is_directory(path, unreadable);
  const fs::path file = folder ? path / kFileName : path;
  if (folder && !fs::exists(file, unreadable)) {
    return fail(ErrorCode::kNotFound, fmt::format("{} has no {}", path.string(), kFileName),
                "give the folder of a run that has ended, made by this version, or a map");
  }
  MapFile out;
  SGS_ASSIGN_OR_RETURN(out.file_, ChunkFile::open(file));
  const auto heads = out.file_.chunks(ChunkKind::kHead);
  if (heads.size() != 1) return damaged(file, "head");
  SGS_ASSIGN_OR_RETURN(const std::string bytes, out.file_.unpacked(heads.front()));
  ArchiveReader archive(bytes);
  archive(out.sessions_);
  if (!archive.complete() || out.sessions_.empty()) return damaged(file, "head");
  out.views_ = out.file_.chunks(ChunkKind::kView);
  return out;
}

Result<MapGaussians> MapFile::gaussians() const {
  MapGaussians all;
  bool first = true;
  for (const Chunk& chunk : file_.chunks(ChunkKind::kGaussians)) {
    SGS_ASSIGN_OR_RETURN(const std::string bytes, file_.unpacked(chunk));
    Columns columns;
    ArchiveReader archive(bytes);
    archive(columns);
    int& degree = all.splats.harmonics.degree;
    if (std::exchange(first, false)) degree = columns.harmonic_degree;
    if (!archive.complete() || !columns.consistent() || columns.harmonic_degree != degree) {
      return damaged(path(),
                     fmt::format("cube {} {} {}", chunk.cube[0], chunk.cube[1], chunk.cube[2]));
    }
    append(columns, all);
  }
  return all;
}

Result<alignment::KnownView> MapFile::view(std::size_t number) const {
  SGS_CHECK(number < views_.size(), "no such view");
  SGS_ASSIGN_OR_RETURN(const std::string bytes, file_.unpacked(views_[number]));
  auto view = view_from(bytes);
  if (!view) return damaged(path(), fmt::format("view {}", number));
  return std::move(*view);
}

Result<MapGraph> MapFile::graph() const {
  const auto chunks = file_.chunks(ChunkKind::kGraph);
  if (chunks.empty()) return MapGraph{std::vector<std::uint16_t>(views_.size(), 0), {}, {}};
  SGS_ASSIGN_OR_RETURN(const std::string bytes, file_.unpacked(chunks.front()));
  Links links;
  ArchiveReader archive(bytes);
  archive(links);
  if (!archive.complete() || !links.consistent(views_.size(), sessions_.size())) {
    return damaged(path(), "graph");
  }
  return std::move(links.graph);
}

bool looks_like_map(const fs::path& path) {
  std::error_code unreadable;
  return fs::is_regular_file(path, unreadable) &&
         path.extension() == fs::path(kFileName).extension();
}

}  // namespace sgs::mapfile
