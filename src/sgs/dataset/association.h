// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace sgs::dataset {

/// Pairs (i, j) of times a[i], b[j] at most `max_difference_s` apart, one to one, ordered by i.
/// Both lists must be sorted. Among all such sets it is one with the most pairs and, of those, the
/// smallest sum of differences. Deviates from the TUM benchmark's `associate.py` (Sturm et al.,
/// IROS 2012), which takes the closest pairs first: where colour lies midway between two depth
/// images that choice leaves whole frames unpaired (one of the first ten of fr1/xyz).
std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           double max_difference_s);

}  // namespace sgs::dataset
