// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "sgs/bag/messages.h"
#include "sgs/core/error.h"
#include "sgs/core/image.h"

namespace sgs::bag {

/// Whether an encoding of sensor_msgs/Image holds depth wherever it appears ("16UC1", "32FC1",
/// "Z16"), may ("mono16", "Y16", "16SC1"), or does not.
enum class DepthEncoding { kYes, kMaybe, kNo };
DepthEncoding depth_encoding(const std::string& encoding);

/// Colour of rgb8, bgr8, rgba8, bgra8, mono8, mono16, 8UC1, 8UC3 (blue first), yuv422 (UYVY),
/// yuv422_yuy2, and MJPG, in either case of letters. Sizes are checked against the data; rows that
/// are said far too short are taken without gaps where this fits. Other encodings are
/// kUnsupported.
Result<ColorImage> decode_color(const ImageMessage& image);
/// Colour of a JPEG or PNG stream; what it is is told from its bytes.
Result<ColorImage> decode_color(const CompressedImageMessage& image);

/// Depth in metres of 16UC1 or mono16 (`units_per_metre` of an integer) and 32FC1 (metres, whatever
/// `units_per_metre` says, unless `scale_floats`). 0, 65535, NaN, infinity and what is negative
/// mean "no measurement".
struct DepthUnit {
  double units_per_metre = 1000;
  bool scale_floats = false;      ///< the unit was given by the user: it counts for floats, too
  bool other_byte_order = false;  ///< than the messages say
};

/// Whether depth is smooth only if its bytes are read in the other order than the message says
/// (is_bigendian is often set wrongly). Of an image without depth, or packed: no.
bool byte_order_contradicts(const ImageMessage& image);

/// Whether the message says rows that are far too short for its data.
bool row_length_contradicts(const ImageMessage& image);

Result<DepthImage> decode_depth(const ImageMessage& image, const DepthUnit& unit);
/// Depth of a 16-bit PNG, also behind the 12 bytes of compressed_depth_image_transport.
Result<DepthImage> decode_depth(const CompressedImageMessage& image, const DepthUnit& unit);

}  // namespace sgs::bag
