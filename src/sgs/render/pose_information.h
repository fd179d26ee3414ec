// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/render/rasterizer.h"

namespace sgs::render {

/// Gauss-Newton approximation of the second derivative of the summed loss in xi of
/// T_world_camera * exp(xi), from the camera's own picture and depth: what a small motion would
/// change in them. `image`: the training image the loss is summed over. Residuals of L1 terms are
/// taken to be 0.03 (colour) and 2 cm (depth) in the mean. Colour without depth counts as if it
/// were at the mean depth.
Matrix6d pose_information(const TrainingImage& image, const LossConfig& loss);

}  // namespace sgs::render
