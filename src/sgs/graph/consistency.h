// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/geometry/se3.h"

namespace sgs::graph {

/// A relative pose with its covariance on right twists of the far end.
struct UncertainPose {
  SE3 T;
  Matrix6d covariance = Matrix6d::Zero();
};

/// A covariance on twists of b as one on twists of a, where T is T_a_b.
Matrix6d carried(const Matrix6d& covariance, const SE3& T);
/// The covariance that goes with an edge's information of any rank: what it says nothing of may be
/// anything within a metre and a radian (one standard deviation).
Matrix6d covariance_of(const Matrix6d& information);

/// One after the other: T_a_b and T_b_c make T_a_c (first order).
UncertainPose operator*(const UncertainPose& a, const UncertainPose& b);
UncertainPose inverse(const UncertainPose& a);
/// Squared Mahalanobis distance of a way round from standing still.
double closure_chi2(const UncertainPose& round);

/// The largest set of items that agree with each other pair by pair (an exact maximum clique by
/// branch and bound; Mangelson, Dominic, Eustice, Vasudevan: Pairwise Consistent Measurement Set
/// Maximization, ICRA 2018). `agrees[i]` has bit j set where i and j agree; at most 64 items. Of
/// equally large sets the one with the lowest numbers.
std::vector<int> largest_agreement(const std::vector<std::uint64_t>& agrees);

}  // namespace sgs::graph
