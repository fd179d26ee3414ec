// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/dataset/frame_source.h"

namespace sgs::app {

/// Reads all of a source into memory (until Ctrl-C) and returns a source that hands it out: for
/// measurements that decoding must not disturb.
std::unique_ptr<dataset::FrameSource> preload(std::unique_ptr<dataset::FrameSource> source);

}  // namespace sgs::app
