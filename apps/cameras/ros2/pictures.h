// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/bag/messages.h"
#include "sgs/core/error.h"
#include "sgs/dataset/image_size.h"

namespace sgs::cameras {

/// A picture as streams carry it: rgb8, depth as 16-bit raw units or as floats in metres.
struct Picture {
  bag::Header header;
  dataset::ImageSize size;
  std::string bytes;
  bool floats = false;  ///< of depth
};

/// Each checks what the message says against its bytes. Errors: unknown encodings, rows that do not
/// fit.
Result<Picture> color_of(const bag::ImageMessage& message);
Result<Picture> color_of(const bag::CompressedImageMessage& message);
Result<Picture> depth_of(const bag::ImageMessage& message);
Result<Picture> depth_of(const bag::CompressedImageMessage& message);

}  // namespace sgs::cameras
