// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/pinhole.h"
#include "sgs/core/archive.h"

namespace sgs {

/// Cameras as fields of an archive.
template <class Archive>
void archive_fields(Archive& a, PinholeCamera& camera) {
  a(camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
}

}  // namespace sgs
