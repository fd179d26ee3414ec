// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "input.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/io/ply.h"
#include "sgs/map/gaussian.h"

namespace sgs::app {

/// Centres of the Gaussians that are more solid than not, as coloured points.
std::vector<io::ColoredPoint> to_points(std::span<const map::Gaussian> gaussians);

/// Camera and keyframes of a run, with the input it was made from.
struct KeyframeViews {
  Input input;
  PinholeCamera camera;
  Trajectory keyframes;
};
/// Opens the input named in the run's config.toml.
Result<KeyframeViews> load_keyframe_views(const std::string& run);

/// Reads the input through and hands over each keyframe's frame with its refined pose.
Status for_each_keyframe(KeyframeViews& views,
                         const std::function<Status(const RgbdFrame&, const SE3&)>& visit);

/// COLMAP text model and keyframe pictures: FOLDER/images and FOLDER/sparse/0, the layout that
/// trainers of Gaussian splatting read.
Status export_colmap(const std::string& run, std::span<const map::Gaussian> gaussians,
                     const std::filesystem::path& folder);

/// How to make a mesh.
struct MeshOptions {
  double voxel_m = 0.015;
  bool measured = false;  ///< fuse the camera's depth instead of the map's
  int threads = 2;
};
/// Coloured mesh of the depth seen from the keyframes, as PLY.
Status export_mesh(const std::string& run, std::span<const map::Gaussian> gaussians,
                   const MeshOptions& options, const std::filesystem::path& path);

}  // namespace sgs::app
