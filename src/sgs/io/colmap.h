// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"
#include "sgs/io/ply.h"

namespace sgs::io {

/// A posed picture of a COLMAP model.
struct ColmapImage {
  std::string name;  ///< of its file below the model's image folder, without spaces
  SE3 T_world_camera;
};

/// Writes cameras.txt, images.txt and points3D.txt (COLMAP's text model) into `folder`: one PINHOLE
/// camera, poses as world-to-camera quaternion w x y z and translation, points without tracks.
/// COLMAP's pixel centres lie at halves, ours at integers: the principal point moves by 0.5.
Status save_colmap_model(const std::filesystem::path& folder, const PinholeCamera& camera,
                         std::span<const ColmapImage> images, std::span<const ColoredPoint> points);

}  // namespace sgs::io
