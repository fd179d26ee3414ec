// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "sgs/api/stop.h"

namespace sgs::api::internal {

struct StopAccess {
  static std::stop_token token(const Stop& stop);
};

}  // namespace sgs::api::internal
