// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/occupancy/volume.h"

namespace sgs::occupancy {

/// Between which heights over the floor things are in a robot's way.
struct HeightBand {
  double low_m = 0.1, high_m = 1.5;
};

/// Where something can drive, seen from above: x to the right, y upwards.
struct OccupancyGrid {
  double resolution_m = 0;
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< outer corner of the cell (0, 0)
  int width = 0, height = 0;
  std::vector<Cell> cells;  ///< row by row, the lowest y first

  Cell at(int x, int y) const {
    return cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(x)];
  }
};

/// The grid of a volume whose z points up: occupied where a surface stands in the band, free where
/// it was seen through at a good part of its heights, unknown elsewhere. As large as what is known.
/// Nothing known within the band, and more cells than fit a picture, are errors.
Result<OccupancyGrid> make_grid(const OccupancyVolume& volume, double floor_m,
                                const HeightBand& band);

/// Writes the pair that map_server and nav2 read: `yaml` and beside it a picture of the same name
/// that ends in .pgm. `comment` goes into the first line.
Status save_grid(const std::filesystem::path& yaml, const OccupancyGrid& grid,
                 const std::string& comment);

}  // namespace sgs::occupancy
