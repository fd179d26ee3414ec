// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace sgs::dataset {

/// Pairs (i, j) of times a[i], b[j] at most `max_difference_s` apart, one to one, ordered by i.
/// Both lists must be sorted. Closest pairs are taken first, as in the TUM benchmark's
/// `associate.py` (Sturm et al., IROS 2012), equal differences in order of i, then j.
std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           double max_difference_s);

}  // namespace sgs::dataset
