// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"
#include "sgs/io/ply.h"

namespace sgs::io {

/// A posed picture of a COLMAP model.
struct ColmapImage {
  std::string name;  ///< of its file below the model's image folder; written ones have no spaces
  SE3 T_world_camera;
  std::vector<std::int64_t> points = {};  ///< of the model that it sees; read, not written
};

/// Writes cameras.txt, images.txt and points3D.txt (COLMAP's text model) into `folder`: one PINHOLE
/// camera, poses as world-to-camera quaternion w x y z and translation, points without tracks.
/// COLMAP's pixel centres lie at halves, ours at integers: the principal point moves by 0.5.
Status save_colmap_model(const std::filesystem::path& folder, const PinholeCamera& camera,
                         std::span<const ColmapImage> images, std::span<const ColoredPoint> points);

/// Reads the posed pictures of a COLMAP text model from its images.txt, in the order of the file;
/// with the points that each sees. Rows that are no pose and quaternions that are far from unit
/// length are errors that name file and line; a file without any picture is one, too.
Result<std::vector<ColmapImage>> load_colmap_images(const std::filesystem::path& path);
/// Reads the points of a COLMAP text model, by number, from its points3D.txt.
Result<std::unordered_map<std::int64_t, Eigen::Vector3d>> load_colmap_points(
    const std::filesystem::path& path);

}  // namespace sgs::io
