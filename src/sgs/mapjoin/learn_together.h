// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sgs/core/thread_pool.h"
#include "sgs/mapjoin/part.h"

namespace sgs::mapjoin {

/// Learns the Gaussians of a part anew from the pictures of all its views, so that those of two
/// maps that show the same surface show it together: steps of the mapper as a run makes them
/// (mapper/mapper.h), with the gains of the views and from where the map looks like them. Poses of
/// views stay. Views that are grey get the colours that the map has from there.
/// Returns the number of steps. The same for any number of threads.
std::int64_t learn_together(Part& part, ThreadPool& pool);

}  // namespace sgs::mapjoin
