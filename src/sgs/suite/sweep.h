// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sgs/suite/table.h"

namespace sgs::suite {

/// A parameter and the values it takes.
struct Range {
  std::string key;
  std::vector<double> values;
};

/// Reads KEY=A:B: geometric steps from A to B, `per_octave` of them in each doubling; KEY may be an
/// alias.
Result<Range> parse_range(const std::string& text, int per_octave,
                          const std::map<std::string, std::string>& aliases);

/// A variant for each value, named by it.
std::vector<Variant> swept_variants(const Variant& base, const Range& range);

/// Mean error over the logarithm of a parameter, one line per column, as an SVG file; the rows are
/// named as swept_variants() are. "" where there is nothing to draw.
std::string sweep_plot(const Grid& grid, const std::string& key);

}  // namespace sgs::suite
