// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "sgs/core/image.h"

namespace sgs::report {

/// Text made safe for HTML content and attribute values; bytes that are not UTF-8 become U+FFFD.
std::string html_escaped(std::string_view text);
/// The picture as a JPEG in a data: URI; empty for an empty picture.
std::string jpeg_data_uri(const ColorImage& image, int quality = 82);
/// Standard base64 with padding.
std::string base64(std::string_view bytes);

}  // namespace sgs::report
