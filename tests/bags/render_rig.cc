// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Renders a room as a colour camera and a depth camera beside it see it, for the tests of bags:
//   sgs_render_rig OUT FRAMES [kinect]
// OUT/color is a TUM folder of the colour camera with its own depth, OUT/depth one of the depth
// camera, with `kinect` of a size that Azure Kinects have; OUT/rig.txt holds T_color_depth as tx ty
// tz qx qy qz qw. Depth is in millimetres, times are i / 32 s after 1000 s.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "sgs/dataset/tum_writer.h"
#include "sgs/io/atomic_file.h"
#include "sgs/synthetic/source.h"

namespace sgs {
namespace {

constexpr double kRate_hz = 32, kStart_s = 1000, kUnitsPerMetre = 1000;
const PinholeCamera kColor{320, 240, 268, 270, 160, 124}, kDepth{280, 210, 210, 212, 141, 104},
    kKinectDepth{320, 288, 252, 253, 161, 147};
const SE3 kColorFromDepth(so3_exp({0.004, -0.01, 0.008}), {0.05, 0.002, -0.003});

Status render_rig(const std::filesystem::path& out, int frames, const PinholeCamera& own) {
  synthetic::SynthOptions options;
  options.scene = "room_desk";
  SGS_ASSIGN_OR_RETURN(const auto scene, synthetic::make_scene(options));
  SGS_ASSIGN_OR_RETURN(const auto motion, synthetic::handheld_trajectory(options));
  dataset::TumSequenceWriter::Options folder;
  folder.depth_scale = kUnitsPerMetre;
  SGS_ASSIGN_OR_RETURN(auto color,
                       dataset::TumSequenceWriter::create(out / "color", kColor, folder));
  SGS_ASSIGN_OR_RETURN(auto depth, dataset::TumSequenceWriter::create(out / "depth", own, folder));
  ThreadPool pool(2);
  const auto add = [&](dataset::TumSequenceWriter& writer, const PinholeCamera& camera,
                       const SE3& T_world_camera, int i) {
    auto view = render_exact(*scene, camera, T_world_camera, pool);
    RgbdFrame frame;
    frame.index = i;
    frame.timestamp_s = kStart_s + i / kRate_hz;
    frame.camera = camera;
    frame.color = std::move(view.color);
    frame.depth = std::move(view.depth);
    frame.truth_T_world_camera = T_world_camera;
    return writer.add(frame);
  };
  for (int i = 0; i < frames; ++i) {
    const double time = motion.poses().front().timestamp_s + 0.1 + i / kRate_hz;
    const auto T_world_color = motion.at(time, 1);
    SGS_CHECK(T_world_color, "the motion is too short");
    SGS_RETURN_IF_ERROR(add(color, kColor, *T_world_color, i));
    SGS_RETURN_IF_ERROR(add(depth, own, *T_world_color * kColorFromDepth, i));
  }
  const Eigen::Vector3d& t = kColorFromDepth.t;
  const Eigen::Quaterniond q = kColorFromDepth.quaternion();
  return io::write_file(out / "rig.txt", fmt::format("{} {} {} {} {} {} {}\n", t.x(), t.y(), t.z(),
                                                     q.x(), q.y(), q.z(), q.w()));
}

}  // namespace
}  // namespace sgs

int main(int argc, char** argv) {
  const bool kinect = argc == 4 && std::string_view(argv[3]) == "kinect";
  if (argc != 3 && !kinect) return 2;
  const auto status =
      sgs::render_rig(argv[1], std::atoi(argv[2]), kinect ? sgs::kKinectDepth : sgs::kDepth);
  if (!status) std::fputs((status.error().text() + "\n").c_str(), stderr);
  return status ? 0 : 1;
}
