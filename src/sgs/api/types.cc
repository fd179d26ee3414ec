// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/types.h"

#include "sgs/api/internal/convert.h"
#include "sgs/api/internal/guard.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::api {

Trajectory Trajectory::load(const std::string& path) {
  return internal::guarded([&] {
    return internal::to_api(internal::value_or_raise(io::load_trajectory(path)).trajectory);
  });
}

void Trajectory::save(const std::string& path) const {
  internal::guarded([&] {
    const auto trajectory = internal::value_or_raise(internal::from_api(*this));
    internal::check_or_raise(io::save_trajectory(path, trajectory));
  });
}

}  // namespace sgs::api
