// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "sgs/camera/pinhole.h"

namespace sgs::app {

/// Size and intrinsics as `--json` prints them.
inline nlohmann::json camera_json(const PinholeCamera& c) {
  return {{"width", c.width}, {"height", c.height}, {"fx", c.fx},
          {"fy", c.fy},       {"cx", c.cx},         {"cy", c.cy}};
}

}  // namespace sgs::app
