// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stop_token>

#include "sgs/dataset/frame_source.h"

namespace sgs::dataset {

/// Reads all of a source into memory (until a stop is requested) and returns a source that hands it
/// out: for measurements that decoding must not disturb.
std::unique_ptr<FrameSource> preload(std::unique_ptr<FrameSource> source,
                                     const std::stop_token& stop = {});

}  // namespace sgs::dataset
