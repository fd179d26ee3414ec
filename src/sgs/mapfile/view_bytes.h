// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sgs/alignment/known_view.h"

namespace sgs::mapfile {

/// A view as bytes that pack well, without its colours, depth in steps of a fifth of a millimetre
/// up to 13 m: each grey value less the mean of those left of it and above it, each depth less the
/// one left of it. What comes out of view_from() goes in again without loss.
std::string view_bytes(const alignment::KnownView& view);

/// The view again; empty where the bytes are none of these.
std::optional<alignment::KnownView> view_from(std::string_view bytes);

}  // namespace sgs::mapfile
