// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sgs::run {

/// Something that happened to the input, beside frames.
struct InputEvent {
  double wall_s = 0;  ///< as wall_time_s()
  std::string what;
};

}  // namespace sgs::run
