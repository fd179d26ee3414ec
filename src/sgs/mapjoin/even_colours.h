// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sgs/mapjoin/part.h"

namespace sgs::mapjoin {

/// A session's colours are as bright as its camera began: gives the Gaussians of sessions from
/// `first_session` on the colours that those before have where both lie in one place. Returns the
/// factors of red, green and blue; 1 where too little is in common.
std::array<float, 3> even_colours(Part& part, std::uint16_t first_session);

}  // namespace sgs::mapjoin
