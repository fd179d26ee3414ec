// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sgs/capture/camera_driver.h"
#include "sgs/geometry/se3.h"
#include "sgs/stream/protocol.h"

// What libraries say of cameras, in our words.
namespace sgs::cameras {

enum class Order { kRows, kColumns };

/// A rigid motion of nine and three numbers of single precision. `unit_m`: of the translation.
SE3 transform_of(std::span<const float, 9> rotation, std::span<const float, 3> translation,
                 Order order, double unit_m);

/// Raw units per metre; libraries say metres per unit in single precision.
double units_per_metre(double unit_m);

/// Leaves the depth camera out of a greeting where it is the colour camera.
void leave_out_equal_cameras(stream::Hello& hello);

/// A size and rate that a sensor can deliver.
struct SensorMode {
  int width = 0, height = 0, fps = 0;
};

/// Which of the modes with the rate that is asked for is the nearest in size; the first of equal
/// ones. `exactly`: of this size or none.
std::optional<std::size_t> nearest_mode(std::span<const SensorMode> modes,
                                        const capture::CameraMode& wanted, bool exactly);

/// Rows without the gaps between them. Empty where the sizes make no sense.
std::string packed_rows(const void* data, int width, int height, int stride_bytes, int pixel_bytes);

/// Bytes r g b of pixels b g r a.
std::string rgb_of_bgra(std::string bytes);

}  // namespace sgs::cameras
