// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/dataset/frame_source.h"

namespace sgs::dataset {

/// The frames of a source at most `max_width` columns wide (0 = no limit), their camera reduced
/// with them (camera/resample.h). A source that is no wider is returned as it is.
std::unique_ptr<FrameSource> reduced(std::unique_ptr<FrameSource> source, int max_width);

}  // namespace sgs::dataset
