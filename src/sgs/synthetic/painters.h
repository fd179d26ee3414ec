// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/synthetic/canvas.h"
#include "sgs/synthetic/random.h"

namespace sgs::synthetic {

/// What stands in a picture or on a surface. All patterns are defined in metres and irregular at
/// several scales; nothing repeats.
enum class Pattern {
  kPlain,    ///< one colour
  kPlaster,  ///< wall paint: faint fractal mottling
  kCarpet,   ///< strong fractal mottling with sharp-edged blotches and specks
  kWood,     ///< grain along x
  kPhoto,    ///< like a photograph: sky, layered hills, blotches, objects
  kPoster,   ///< coloured sheet with photographs, headings, text and shapes
  kText,     ///< a page of character-like strokes
};

/// A random colour: hue any, saturation and value within the given limits.
Rgb random_color(Random& random, float saturation_lo, float saturation_hi, float value_lo,
                 float value_hi);

/// Paints all of the canvas. `base` colours kPlain, kPlaster, kCarpet and kWood.
void paint(Canvas& canvas, Pattern pattern, std::uint64_t seed, const Rgb& base);

/// Covers a surface with a ground pattern and posters lying on it, turned at random, about one per
/// `spacing_m` squared, each different. `turned` false leaves them upright and apart, as on a wall.
struct PosterOptions {
  float spacing_m = 0.6f;
  float size_m = 0.55f;
  bool turned = true;
};
void scatter_posters(Canvas& canvas, const PosterOptions& options, std::uint64_t seed,
                     ThreadPool& pool);

}  // namespace sgs::synthetic
