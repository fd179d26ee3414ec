// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/map_file_export.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <vector>

#include "sgs/export/occupancy_export.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/synthetic/scene.h"
#include "sgs/synthetic/source.h"

namespace sgs::run {
namespace {

using ::testing::HasSubstr;

constexpr PinholeCamera kMapCamera{160, 120, 133.85, 134.8, 79.6, 61.5};
constexpr double kEyeHeight_m = 1.4;

/// A map file of somebody who turns round in a room of the flat, in the world of the first camera.
class MapOfARoom : public ::testing::Test {
 protected:
  MapOfARoom() {
    synthetic::SynthOptions options;
    options.scene = "flat";
    options.camera = kMapCamera;
    const auto scene = *synthetic::make_scene(options);
    ThreadPool pool(2);
    Eigen::Matrix3d R;
    R << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // the camera's axes to x forward, y left, z up
    std::vector<alignment::KnownView> views;
    mapfile::MapContents map;
    for (int i = 0; i < 24; ++i) {
      const Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.26 * i, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()))
                                       .toRotationMatrix();
      const SE3 T(turn * R, {1.5, 1.5, kEyeHeight_m});
      const auto seen = synthetic::render_exact(*scene, kMapCamera, T, pool);
      if (i == 0) T_flat_map_ = T;
      alignment::KnownView view;
      view.timestamp_s = i;
      view.T_world_camera = (T_flat_map_.inverse() * T).normalized();
      view.frame.camera = kMapCamera;
      view.frame.color = seen.color;
      view.frame.depth = seen.depth;
      views.push_back(std::move(view));
    }
    map.sessions = {{"flat", "1", kMapCamera, 0, 24, 24, ""}};
    map.gaussians.splats.gaussians = {map::Gaussian{}};
    map.gaussians.born_in = {0};
    map.gaussians.born_s = {0};
    map.views = views.size();
    map.view = [&](std::size_t i) { return views[i]; };
    map.graph.session.assign(views.size(), 0);
    for (const auto& view : views) map.graph.T_map_camera.push_back(view.T_world_camera);
    const auto saved = mapfile::save_map(path(), map);
    if (!saved) ADD_FAILURE() << saved.error().text();
  }
  std::filesystem::path path() const { return folder_.path() / "room.sgsmap"; }

  io::TemporaryFolder folder_;
  SE3 T_flat_map_;
};

TEST_F(MapOfARoom, LevelSurfacesSayWhichWayIsUp) {
  const auto map = mapfile::MapFile::open(path());
  ASSERT_TRUE(map) << map.error().text();
  const auto upright = upright_of_map(*map);
  ASSERT_TRUE(upright) << upright.error().text();
  EXPECT_EQ(upright->by, UprightBy::kFloor);
  EXPECT_GT((T_flat_map_.R * upright->up).z(), 0.9998);  // a degree
}

TEST_F(MapOfARoom, ItsOccupancyHasTheFloorAndWhatIsFree) {
  const auto seen = occupancy_of(path(), {});
  ASSERT_TRUE(seen) << seen.error().text();
  ASSERT_TRUE(seen->floor_m);
  const double first_m = seen->T_upright_world.t.z();
  EXPECT_NEAR(first_m - *seen->floor_m, kEyeHeight_m, 0.03);
  const auto grid = grid_of_run(*seen, {});
  ASSERT_TRUE(grid) << grid.error().text();
  int free = 0;
  for (int y = 0; y < grid->height; ++y) {
    for (int x = 0; x < grid->width; ++x) {
      free += grid->at(x, y) == occupancy::Cell::kFree ? 1 : 0;
    }
  }
  EXPECT_GT(free * grid->resolution_m * grid->resolution_m, 2);  // square metres
}

TEST_F(MapOfARoom, ItsGaussiansAreAMap) {
  const auto map = load_any_map(path());
  ASSERT_TRUE(map) << map.error().text();
  EXPECT_EQ(map->gaussians.size(), 1u);
}

TEST_F(MapOfARoom, DrawnDepthIsNotItsOwn) {
  OccupancyOptions options;
  options.from_map = true;
  const auto seen = occupancy_of(path(), options);
  ASSERT_FALSE(seen);
  EXPECT_THAT(seen.error().remedy, HasSubstr("--from-map"));
}

}  // namespace
}  // namespace sgs::run
