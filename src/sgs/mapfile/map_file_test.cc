// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapfile/map_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::mapfile {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr PinholeCamera kCamera{16, 12, 20, 21, 7.5, 5.5};

/// A view with every kind of pixel: bright and dark, near, far and unmeasured.
alignment::KnownView view_at(double x, std::uint64_t seed) {
  alignment::KnownView view;
  view.timestamp_s = 100 + x;
  view.T_world_camera = SE3(so3_exp({0.1, -0.2, 0.3}), {x, -5, 0.25});
  view.motion.readout << 1, 2, 3, 4, 5, 6;
  view.motion.depth_delay_s = 0.01;
  view.ferns = {0, 7, features::Ferns::kUnknown};
  view.fern_seed = seed;
  view.frame.camera = kCamera;
  view.frame.index = 42;
  view.frame.timestamp_s = view.timestamp_s;
  view.frame.color = ColorImage(kCamera.width, kCamera.height);
  view.frame.depth = DepthImage(kCamera.width, kCamera.height);
  PixelMask seen(kCamera.width, kCamera.height);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto g = static_cast<std::uint8_t>(37 * i);
    view.frame.color.data()[i] = {g, g, g};
    seen.data()[i] = g > 0 ? 1 : 0;
    const auto units = static_cast<std::uint16_t>(i % 5 == 0 ? 0 : 12345 * i);
    view.frame.depth.data()[i] = static_cast<float>(units) / 5000;
  }
  view.frame.seen = std::make_shared<const PixelMask>(std::move(seen));
  return view;
}

MapContents small_map() {
  MapContents map;
  map.sessions = {{"room", "0.1", kCamera, 10, 20, 300, "format = 1\n"}};
  for (int i = 0; i < 5; ++i) {
    map::Gaussian g{};
    g.mean[0] = 3.0f * static_cast<float>(i) - 5;  // three cubes
    g.rotation[0] = 1;
    g.rgb[2] = 0.125f * static_cast<float>(i);
    map.gaussians.splats.gaussians.push_back(g);
    map.gaussians.born_in.push_back(0);
    map.gaussians.born_s.push_back(10.5 + i);
  }
  map.views = 2;
  map.view = [](std::size_t i) { return view_at(static_cast<double>(i), 3); };
  map.graph.session = {0, 0};
  map.graph.T_map_camera.resize(2);
  return map;
}

TEST(MapFile, GivesBackWhatItWasGiven) {
  const io::TemporaryFolder scratch;
  const MapContents written = small_map();
  ASSERT_TRUE(save_map(scratch / kFileName, written));
  const auto map = MapFile::open(scratch.path());  // the folder that it lies in
  ASSERT_TRUE(map) << map.error().text();
  ASSERT_EQ(map->sessions().size(), 1u);
  EXPECT_EQ(map->sessions()[0].name, "room");
  EXPECT_EQ(map->sessions()[0].camera, kCamera);
  EXPECT_EQ(map->sessions()[0].frames, 300);
  EXPECT_EQ(map->sessions()[0].calibration, "format = 1\n");
  const auto gaussians = map->gaussians();
  ASSERT_TRUE(gaussians);
  EXPECT_EQ(map->file().chunks(ChunkKind::kGaussians).size(), 4u);
  ASSERT_EQ(gaussians->splats.gaussians.size(), 5u);
  for (int i = 0; i < 5; ++i) {  // in the order of the cubes, which here is theirs
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(gaussians->splats.gaussians[at].mean[0], 3.0f * static_cast<float>(i) - 5);
    EXPECT_EQ(gaussians->splats.gaussians[at].rgb[2], 0.125f * static_cast<float>(i));
    EXPECT_EQ(gaussians->born_s[at], 10.5 + i);
  }
  ASSERT_EQ(map->views(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto view = map->view(i);
    ASSERT_TRUE(view);
    const alignment::KnownView expected = written.view(i);
    EXPECT_EQ(view->T_world_camera.t, expected.T_world_camera.t);
    EXPECT_EQ(view->motion.readout, expected.motion.readout);
    EXPECT_EQ(view->ferns, expected.ferns);
    EXPECT_EQ(view->fern_seed, 3u);
    EXPECT_EQ(view->frame.index, 42);
    EXPECT_EQ(view->frame.camera, kCamera);
    ASSERT_TRUE(view->frame.seen);
    for (std::size_t p = 0; p < view->frame.color.size(); ++p) {
      EXPECT_EQ(view->frame.color.data()[p].g, expected.frame.color.data()[p].g);
      EXPECT_EQ(view->frame.depth.data()[p], expected.frame.depth.data()[p]);
      EXPECT_EQ(view->frame.seen->data()[p], expected.frame.seen->data()[p]);
    }
  }
}

TEST(MapFile, KeepsHarmonicsAndUnknownBirths) {
  const io::TemporaryFolder scratch;
  MapContents written = small_map();
  written.gaussians.born_s[1] = std::numeric_limits<double>::quiet_NaN();
  auto& harmonics = written.gaussians.splats.harmonics;
  harmonics.degree = 1;
  harmonics.resize(5);
  harmonics.of(4)[8] = 0.5f;
  ASSERT_TRUE(save_map(scratch / "m", written));
  const auto map = MapFile::open(scratch / "m");
  ASSERT_TRUE(map) << map.error().text();
  const auto gaussians = map->gaussians();
  ASSERT_TRUE(gaussians);
  EXPECT_TRUE(std::isnan(gaussians->born_s[1]));
  ASSERT_EQ(gaussians->splats.harmonics.size(), 5u);
  EXPECT_EQ(gaussians->splats.harmonics.of(4)[8], 0.5f);
}

TEST(MapFile, KeepsSessionsAndHowViewsHangTogether) {
  const io::TemporaryFolder scratch;
  MapContents written = small_map();
  written.sessions.push_back({"room again", "0.1", kCamera, 1, 2, 30, ""});
  written.gaussians.born_in[4] = 1;
  const SE3 way(so3_exp({0.1, 0.2, -0.1}), {1, 2, 3});
  written.graph = {{0, 1}, {SE3{}, way}, {{0, 1, way, 5 * Matrix6d::Identity(), false}}};
  ASSERT_TRUE(save_map(scratch / "m", written));
  const auto map = MapFile::open(scratch / "m");
  ASSERT_TRUE(map) << map.error().text();
  EXPECT_EQ(map->sessions().size(), 2u);
  EXPECT_EQ(map->gaussians()->born_in[4], 1);
  const auto graph = map->graph();
  ASSERT_TRUE(graph) << graph.error().text();
  EXPECT_EQ(graph->session, written.graph.session);
  EXPECT_EQ(graph->T_map_camera[1].t, way.t);
  ASSERT_EQ(graph->edges.size(), 1u);
  EXPECT_EQ(graph->edges[0].T_from_to.t, way.t);
  EXPECT_EQ(graph->edges[0].information, written.graph.edges[0].information);
  EXPECT_FALSE(graph->edges[0].doubtful);
  // What cannot be is refused by name.
  written.graph.edges[0].to = 2;
  ASSERT_TRUE(save_map(scratch / "wrong", written));
  const auto wrong = MapFile::open(scratch / "wrong");
  ASSERT_TRUE(wrong);
  EXPECT_THAT(wrong->graph().error().message, HasSubstr("graph"));
}

TEST(MapFile, RefusesEveryCutAndEveryWrongByte) {
  const io::TemporaryFolder scratch;
  const fs::path path = scratch / "m";
  ASSERT_TRUE(save_map(path, small_map()));
  const std::string whole = *io::read_file(path);
  const auto expect_refused = [&](const std::string& bytes) {
    ASSERT_TRUE(io::write_file(path, bytes, io::Durability::kRelaxed));
    const auto map = MapFile::open(path);
    ASSERT_FALSE(map);
    EXPECT_THAT(map.error().message, HasSubstr(path.string()));
    EXPECT_FALSE(map.error().remedy.empty());
  };
  for (std::size_t size = 0; size < whole.size(); size += 3) expect_refused(whole.substr(0, size));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    expect_refused(damaged);
  }
  expect_refused(whole + "x");
}

TEST(MapFile, NamesWhatIsWrong) {
  const io::TemporaryFolder scratch;
  const fs::path path = scratch / "m";
  const auto error_of = [&](const std::string& bytes) {
    EXPECT_TRUE(io::write_file(path, bytes, io::Durability::kRelaxed));
    return MapFile::open(path).error();
  };
  ASSERT_TRUE(save_map(path, small_map()));
  std::string bytes = *io::read_file(path);
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\n").message, HasSubstr("no map"));
  EXPECT_THAT(error_of(bytes.substr(0, bytes.size() / 2)).message, HasSubstr("cut off"));
  bytes[8] = 9;  // the format
  const Error later = error_of(bytes);
  EXPECT_EQ(later.code, ErrorCode::kUnsupported);
  EXPECT_THAT(later.message, HasSubstr("format 9"));
  EXPECT_THAT(MapFile::open(scratch / "none").error().message, HasSubstr("none"));
  EXPECT_THAT(MapFile::open(scratch.path()).error().message, HasSubstr("map.sgsmap"));
}

}  // namespace
}  // namespace sgs::mapfile
