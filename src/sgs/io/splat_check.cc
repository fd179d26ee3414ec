// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/splat_check.h"

#include <algorithm>
#include <cmath>

namespace sgs::io {
namespace {

double rotation_norm(const map::Gaussian& g) {
  return std::hypot(std::hypot(double{g.rotation[0]}, double{g.rotation[1]}),
                    std::hypot(double{g.rotation[2]}, double{g.rotation[3]}));
}

}  // namespace

Status check_splats(const std::filesystem::path& path, std::span<const map::Gaussian> splats,
                    const map::Harmonics& harmonics) {
  SGS_CHECK(harmonics.empty() || harmonics.size() == splats.size(), "harmonics of another map");
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const map::Gaussian& g = splats[i];
    const double norm = rotation_norm(g);
    bool finite = std::isfinite(g.opacity_logit) && std::isfinite(norm) && norm > 0;
    for (int k = 0; k < 3; ++k) {
      finite = finite && std::isfinite(g.mean[k]) && std::isfinite(g.log_scale[k]) &&
               std::isfinite(g.rgb[k]);
    }
    if (!harmonics.empty()) {
      for (const float c : harmonics.of(i)) finite = finite && std::isfinite(c);
    }
    if (!finite) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: Gaussian {} has a value that is not finite or a zero rotation; "
                              "nothing was written",
                              path.string(), i));
    }
  }
  return {};
}

std::array<double, 4> unit_rotation(const map::Gaussian& g) {
  const double norm = rotation_norm(g);
  return {g.rotation[0] / norm, g.rotation[1] / norm, g.rotation[2] / norm, g.rotation[3] / norm};
}

float opacity_logit(double opacity) {
  // The sigmoid of this differs from 1 by one float step.
  constexpr double kMaxLogit = 16;
  if (opacity <= 0) return -kMaxLogit;
  if (opacity >= 1) return kMaxLogit;
  return static_cast<float>(std::clamp(std::log(opacity / (1 - opacity)), -kMaxLogit, kMaxLogit));
}

}  // namespace sgs::io
