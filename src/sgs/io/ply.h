// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/core/image.h"
#include "sgs/map/gaussian.h"
#include "sgs/map/harmonics.h"

namespace sgs::io {

/// Reads splats from a PLY in the vertex layout of 3D Gaussian Splatting (Kerbl et al. 2023):
/// x y z, f_dc_0..2 (SH degree 0: rgb = 0.5 + 0.28209479 f_dc), opacity before the sigmoid,
/// scale_0..2 as logarithms, rot_0..3 as w x y z. Properties are found by name, so any order, any
/// scalar type and any further properties (normals) are accepted, in ascii or binary_little_endian.
/// f_rest_* are read where they are those of degree 1, 2 or 3 (9, 24 or 45 of them; red, green and
/// blue one after the other), else dropped. Missing properties, a truncated body and values that
/// are not finite are errors that name the file, but for an infinite opacity, which is 0 or 1.
/// Opacity logits are clamped to +-16.
Result<map::SplatMap> load_splats(const std::filesystem::path& path);

/// Writes splats in that layout: binary little endian, all float, normals zero, quaternions
/// normalised; f_rest_* where there are `harmonics`. Values that are not finite are an error and
/// nothing is written.
Status save_splats(const std::filesystem::path& path, std::span<const map::Gaussian> splats,
                   const map::Harmonics& harmonics = {});

/// One point of a point cloud, metres.
struct ColoredPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Rgb8 color;
};

/// Writes a point cloud (x y z float, red green blue uchar, binary little endian).
Status save_points(const std::filesystem::path& path, std::span<const ColoredPoint> points);

/// Writes a triangle mesh with coloured vertices (binary little endian); counter-clockwise
/// triangles face the viewer.
Status save_mesh(const std::filesystem::path& path, std::span<const ColoredPoint> vertices,
                 std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace sgs::io
