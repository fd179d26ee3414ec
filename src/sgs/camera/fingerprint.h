// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sgs/camera/rgbd_frame.h"

namespace sgs {

/// A number by which a frame is known again: from its size, the colours of some two thousand
/// pixels and whether their depth was measured. In [1, 2^48), so that no text format loses any of
/// it. A recording that was replaced or edited is noticed; a few changed pixels need not be.
std::int64_t fingerprint(const RgbdFrame& frame);

/// The same of the depths of those pixels, to the last bit.
std::int64_t depth_fingerprint(const RgbdFrame& frame);

}  // namespace sgs
