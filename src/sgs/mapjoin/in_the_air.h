// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sgs/mapjoin/part.h"

namespace sgs::mapjoin {

/// At the borders of what a map has seen Gaussians hang in the air. Two maps in one world, sessions
/// before `first_session` and those from it on: removes Gaussians that a view of the other map saw
/// through and that lie on nothing that a view of their own map saw. Returns how many.
std::size_t drop_in_the_air(Part& part, std::uint16_t first_session);

}  // namespace sgs::mapjoin
