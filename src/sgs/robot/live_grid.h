// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/history/path.h"
#include "sgs/occupancy/floor.h"
#include "sgs/occupancy/grid.h"
#include "sgs/occupancy/volume.h"

namespace sgs::robot {

struct GridOptions {
  occupancy::VolumeConfig volume = {};
  occupancy::HeightBand band = {};
  /// Views that are remembered, to be counted again where the past has changed (some 200 kB each).
  std::size_t most_views = 1000;
  /// Of these at most so many are counted again for one grid: who publishes poses waits meanwhile.
  std::size_t recounted_at_once = 20;
};

/// Which floor is free, while a run goes on: counts as `sgs export grid` does, and counts anew when
/// the path has moved by more than a voxel, a few views with each grid that is asked for. One
/// thread.
class LiveGrid {
 public:
  explicit LiveGrid(const GridOptions& options, const SE3& T_upright_map);

  /// A view of a frame of the path; left out where the camera has hardly moved since the last one.
  void see(const RgbdFrame& frame, const history::Path& path);
  /// The grid, as the path is now or was a little before; empty as long as no floor was seen.
  std::optional<occupancy::OccupancyGrid> grid(const history::Path& path);
  /// The same once all views are counted where they are now.
  std::optional<occupancy::OccupancyGrid> whole_grid(const history::Path& path);

 private:
  /// Single precision: there are many.
  struct Sample {
    Eigen::Vector3f point, normal;
    float area_m2;
  };
  struct View {
    std::int64_t frame = 0;
    SE3 counted_at;  ///< pose in the map
    std::vector<Sample> samples;
  };
  struct Counts {
    occupancy::OccupancyVolume volume;
    occupancy::FloorFinder floor;
  };
  /// Views that are counted again, up to the next one.
  struct Recount {
    Counts counts;
    std::size_t next = 0;
  };
  void count(const View& view, const SE3& T_map_camera, Counts& counts);
  bool has_moved(const history::Path& path) const;
  void recount(const history::Path& path, std::size_t most);
  std::optional<occupancy::OccupancyGrid> counted();

  GridOptions options_;
  SE3 T_upright_map_;
  std::deque<View> views_;
  Counts counts_;
  std::optional<Recount> recount_;
  bool full_ = false;              // more voxels than memory may hold
  std::optional<double> floor_m_;  ///< as it was last found
};

}  // namespace sgs::robot
