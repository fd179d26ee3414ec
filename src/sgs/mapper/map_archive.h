// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "sgs/core/archive.h"
#include "sgs/map/gaussian_store.h"

template <>
inline constexpr bool sgs::archived_as_bytes<sgs::map::Gaussian> = true;
template <>
inline constexpr bool sgs::archived_as_bytes<sgs::map::Moments> = true;

namespace sgs::map {

// The map's types as fields of an archive.

template <class Archive>
void archive_fields(Archive& a, Anchor& anchor) {
  a(anchor.point, anchor.normal, anchor.sigma_n_m, anchor.keyframe, anchor.id);
}

template <class Archive>
void archive_fields(Archive& a, GaussianStore& store) {
  a(store.raw, store.average, store.moments, store.steps, store.max_log_scale, store.anchors,
    store.next_id);
}

/// Whether the arrays fit each other; those of a file may not.
inline bool consistent(const GaussianStore& store) {
  const std::size_t count = store.size();
  return store.average.size() == count && store.moments.size() == count &&
         store.steps.size() == count && store.max_log_scale.size() == count &&
         store.anchors.size() == count;
}

}  // namespace sgs::map
