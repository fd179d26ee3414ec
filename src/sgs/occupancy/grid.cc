// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/occupancy/grid.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

#include "sgs/io/atomic_file.h"

namespace sgs::occupancy {
namespace {

/// Voxels of a column within the band.
struct Column {
  int free = 0, occupied = 0;
};

/// The layers of voxels whose middles lie within the band.
struct Layers {
  int first = 0, last = 0;  // both in it

  Layers(double voxel_m, double floor_m, const HeightBand& band)
      : first(static_cast<int>(std::ceil((floor_m + band.low_m) / voxel_m - 0.5))),
        last(static_cast<int>(std::floor((floor_m + band.high_m) / voxel_m - 0.5))) {}
  bool holds(int z) const { return z >= first && z <= last; }
  int count() const { return last - first + 1; }
};

Cell cell_of(const Column& column, int layers) {
  constexpr double kGoodPart = 0.3;  // a camera in the hand seldom sees all heights of a place
  if (column.occupied > 0) return Cell::kOccupied;
  return column.free > 0 && column.free >= kGoodPart * layers ? Cell::kFree : Cell::kUnknown;
}

/// As map_server's map_saver paints them; kept apart by the thresholds below.
char shade(Cell cell) {
  constexpr std::uint8_t kFree = 254, kOccupied = 0, kUnknown = 205;
  return static_cast<char>(cell == Cell::kFree       ? kFree
                           : cell == Cell::kOccupied ? kOccupied
                                                     : kUnknown);
}

/// A file's name as YAML takes it, whatever is in it.
std::string quoted(const std::string& name) {
  std::string out = "'";
  for (const char c : name) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

}  // namespace

Result<OccupancyGrid> make_grid(const OccupancyVolume& volume, double floor_m,
                                const HeightBand& band) {
  // limit: cells of a grid that `sgs export grid` writes
  constexpr std::int64_t kMaxCells = std::int64_t{1} << 28;
  const Layers layers(volume.voxel_m(), floor_m, band);
  if (layers.count() < 1) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("no voxel of {} m lies between {} and {} m over the floor",
                            volume.voxel_m(), band.low_m, band.high_m),
                "a finer --resolution, or --heights farther apart");
  }
  Eigen::AlignedBox2i box;
  volume.for_each([&](const Eigen::Vector3i& voxel, Cell) {
    if (layers.holds(voxel.z())) box.extend(Eigen::Vector2i(voxel.head<2>()));
  });
  if (box.isEmpty()) {
    return fail(
        ErrorCode::kNotFound,
        fmt::format("nothing was seen between {} and {} m over the floor, which is at {:.2f} m",
                    band.low_m, band.high_m, floor_m),
        "other --heights, or --camera-height if that is not the floor");
  }
  const Eigen::Vector2i size = box.sizes() + Eigen::Vector2i::Ones();
  if (std::int64_t{size.x()} * size.y() > kMaxCells) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("a grid of {} x {} cells is too large", size.x(), size.y()),
                "a larger --resolution");
  }
  std::vector<Column> columns(static_cast<std::size_t>(size.x()) *
                              static_cast<std::size_t>(size.y()));
  volume.for_each([&](const Eigen::Vector3i& voxel, Cell cell) {
    if (!layers.holds(voxel.z())) return;
    const Eigen::Vector2i at = voxel.head<2>() - box.min();
    Column& column = columns[static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(size.x()) +
                             static_cast<std::size_t>(at.x())];
    ++(cell == Cell::kFree ? column.free : column.occupied);
  });
  OccupancyGrid grid{
      volume.voxel_m(), volume.voxel_m() * box.min().cast<double>(), size.x(), size.y(), {}};
  grid.cells.reserve(columns.size());
  for (const Column& column : columns) grid.cells.push_back(cell_of(column, layers.count()));
  return grid;
}

Status save_grid(const std::filesystem::path& yaml, const OccupancyGrid& grid,
                 const std::string& comment) {
  std::filesystem::path picture = yaml;
  picture.replace_extension(".pgm");
  std::string pixels =
      fmt::format("P5\n# {} m per pixel\n{} {}\n255\n", grid.resolution_m, grid.width, grid.height);
  for (int y = grid.height - 1; y >= 0; --y) {  // pictures begin above
    for (int x = 0; x < grid.width; ++x) pixels += shade(grid.at(x, y));
  }
  SGS_RETURN_IF_ERROR(io::write_file(picture, pixels));
  return io::write_file(yaml, fmt::format("# {}\n"
                                          "image: {}\n"
                                          "mode: trinary\n"
                                          "resolution: {}\n"
                                          "origin: [{:.6f}, {:.6f}, 0.0]\n"
                                          "negate: 0\n"
                                          "occupied_thresh: 0.65\n"
                                          "free_thresh: 0.196\n",
                                          comment, quoted(picture.filename().string()),
                                          grid.resolution_m, grid.origin_m.x(), grid.origin_m.y()));
}

}  // namespace sgs::occupancy
