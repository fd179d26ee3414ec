// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/bag_export.h"

#include <array>

#include "sgs/export/scene_export.h"
#include "sgs/io/atomic_file.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {
namespace {

constexpr const char* kWorldFrame = "world";
constexpr const char* kMapFrame = "map";
constexpr const char* kCameraFrame = "camera";

/// The map has the axes of the first picture: x right, y down, z forward. ROS looks along x, with z
/// up: as the run found it, else as if the first picture had been taken level.
SE3 T_world_map(const std::filesystem::path& run_folder) {
  if (const auto upright = load_run_upright(run_folder)) return *upright;
  SE3 T;
  T.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T;
}

}  // namespace

Status export_bag(const std::filesystem::path& run_folder, std::span<const map::Gaussian> gaussians,
                  bag::BagWriter& writer, const std::filesystem::path& file) {
  SGS_ASSIGN_OR_RETURN(const Trajectory poses, load_run_trajectory(run_folder));
  if (poses.empty()) {
    return fail(ErrorCode::kNotFound, fmt::format("{}: no poses to write", run_folder.string()),
                "give a run folder with a trajectory");
  }
  const bag::Encoding encoding = writer.encoding();
  const std::size_t tf = writer.add_topic("/tf", bag::WrittenType::kTransforms);
  const std::size_t pose_topic = writer.add_topic("/pose", bag::WrittenType::kPose);
  const std::size_t path = writer.add_topic("/path", bag::WrittenType::kPath);
  const std::size_t cloud = writer.add_topic("/map", bag::WrittenType::kCloud);
  const SE3 T_world = T_world_map(run_folder);
  const std::int64_t first_ns = bag::nanoseconds_of(poses.poses().front().timestamp_s);
  const bag::Header first = {first_ns, kMapFrame};
  writer.write(path, first_ns, bag::write_path(first, poses, encoding));
  writer.write(cloud, first_ns, bag::write_cloud(first, to_points(gaussians), encoding));
  for (const StampedPose& pose : poses.poses()) {
    const std::int64_t time_ns = bag::nanoseconds_of(pose.timestamp_s);
    const std::array transforms = {
        bag::TransformMessage{{time_ns, kWorldFrame}, kMapFrame, T_world},
        bag::TransformMessage{{time_ns, kMapFrame}, kCameraFrame, pose.T_world_camera}};
    writer.write(tf, time_ns, bag::write_transforms(transforms, encoding));
    writer.write(pose_topic, time_ns,
                 bag::write_pose({{time_ns, kMapFrame}, "", pose.T_world_camera}, encoding));
  }
  SGS_ASSIGN_OR_RETURN(const std::string bytes, writer.finish());
  return io::write_file(file, bytes);
}

}  // namespace sgs::run
