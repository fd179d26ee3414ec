// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/map/gaussian_store.h"

namespace sgs::map {

void GaussianStore::append(const Gaussian& gaussian, const Anchor& anchor,
                           float largest_log_scale) {
  raw.push_back(gaussian);
  average.push_back(gaussian);
  moments.push_back({});
  steps.push_back(0);
  max_log_scale.push_back(largest_log_scale);
  anchors.push_back(anchor);
  anchors.back().id = next_id++;
}

std::size_t GaussianStore::remove_if(const std::function<bool(std::size_t)>& remove) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (remove(i)) continue;
    if (kept != i) {
      raw[kept] = raw[i];
      average[kept] = average[i];
      moments[kept] = moments[i];
      steps[kept] = steps[i];
      max_log_scale[kept] = max_log_scale[i];
      anchors[kept] = anchors[i];
    }
    ++kept;
  }
  const std::size_t removed = size() - kept;
  raw.resize(kept);
  average.resize(kept);
  moments.resize(kept);
  steps.resize(kept);
  max_log_scale.resize(kept);
  anchors.resize(kept);
  return removed;
}

}  // namespace sgs::map
