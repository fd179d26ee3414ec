// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "sgs/render/view.h"

/// The per-Gaussian mathematics instantiated for plain double.
namespace sgs::render::reference::scalar {

inline double mul_add(double a, double b, double c) { return a * b + c; }
inline double neg_mul_add(double a, double b, double c) { return c - a * b; }
inline double square_root(double a) { return std::sqrt(a); }
inline double exp2_of(double a) { return std::exp2(a); }
inline double log2_of(double a) { return std::log2(a); }
inline double minimum(double a, double b) { return std::min(a, b); }
inline double maximum(double a, double b) { return std::max(a, b); }
inline double one_where_equal(double a, double b) { return a == b ? 1.0 : 0.0; }

#define SGS_SPLAT_INLINE inline
#include "sgs/render/splat_math.inl"
#undef SGS_SPLAT_INLINE

}  // namespace sgs::render::reference::scalar
