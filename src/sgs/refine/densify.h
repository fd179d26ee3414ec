// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sgs/map/gaussian_store.h"
#include "sgs/refine/learned_harmonics.h"

namespace sgs::refine {

/// Never seen from anywhere: no pixel's extent is known.
inline constexpr float kNeverSeen = 1e30f;

/// What the steps so far have shown of each Gaussian.
struct GaussianNotes {
  std::vector<float> pull;     ///< sum of |d loss / d mean|, per pixel of shift in the image
  std::vector<float> pixel_m;  ///< smallest extent of a pixel at its place so far, metres
  /// Makes room for `count` Gaussians; new ones have not been seen.
  void begin(std::size_t count);
  /// Older pulls count less from now on.
  void fade();
};

/// Removes what is fainter than `opacity` or not finite. Returns how many went.
std::size_t remove_useless(double opacity, map::GaussianStore& store, GaussianNotes& notes,
                           LearnedHarmonics& harmonics);

/// Splits the `count` Gaussians that ask for it most, in the order of
///   pull * sqrt(largest standard deviation in pixels):
/// the picture pulls at them in different directions, so they are too coarse for it (Kerbl et al.
/// 2023, section 5.2; a budget instead of a threshold as in Mallick et al., Taming 3DGS, 2024).
/// Two halves side by side along the longest axis replace each; one takes its place, the other goes
/// to the end. Those no larger than `least_sigma_px` do not split. Returns how many did.
std::size_t split_most_pulled(std::size_t count, double least_sigma_px, map::GaussianStore& store,
                              GaussianNotes& notes, LearnedHarmonics& harmonics);

/// The two halves of a Gaussian along its longest axis. Together they look nearly as it did.
std::pair<map::Gaussian, map::Gaussian> halves(const map::Gaussian& whole);

}  // namespace sgs::refine
