// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "sgs/core/error.h"
#include "sgs/core/image.h"

namespace sgs::io {

/// Reads an 8-bit PNG or JPEG. Grey images are spread over the three channels, alpha is dropped,
/// EXIF orientation is ignored. Errors name the file: kNotFound / kIo when it cannot be read,
/// kInvalidFormat when it is empty, truncated or damaged, kUnsupported for other formats and for
/// 16 bits per channel (most often a depth image where colour belongs).
Result<ColorImage> load_color(const std::filesystem::path& path);
/// How a viewer turns a picture before it shows it, which load_color() does not: 1 = not at all, 2
/// to 8 as Exif numbers it. 1 where the file cannot be read.
int viewer_orientation(const std::filesystem::path& path);

/// Reads a 16-bit single-channel PNG of raw depth and divides by `depth_scale` (raw units per
/// metre, > 0). Raw 0 and 65535 become 0, "no measurement". Errors as for load_color; 8-bit or
/// multi-channel images are kUnsupported.
Result<DepthImage> load_depth(const std::filesystem::path& path, double depth_scale);

/// The same from the bytes of a file that `name` names in errors.
Result<ColorImage> decode_color(std::string bytes, const std::string& name);
Result<DepthImage> decode_depth(std::string bytes, const std::string& name, double depth_scale);
/// Depth as stored: 16 bits a pixel, in units that a calibration names.
using RawDepth = Image<std::uint16_t>;
/// The raw values of a 16-bit single-channel PNG.
Result<RawDepth> decode_raw_depth(std::string bytes, const std::string& name);
Result<RawDepth> load_raw_depth(const std::filesystem::path& path);
/// Raw depth divided by `depth_scale` (raw units per metre, > 0). Raw 0 and 65535 become 0, "no
/// measurement".
DepthImage depth_in_metres(const RawDepth& raw, double depth_scale);

/// Reads an 8-bit image without colour, such as the confidence of each depth. Errors as for
/// load_color.
Result<GrayImage> load_gray(const std::filesystem::path& path);

/// Writes PNG or JPEG by the extension (.png, .jpg, .jpeg); `jpeg_quality` 1..100.
Status save_color(const std::filesystem::path& path, const ColorImage& image,
                  int jpeg_quality = 95);

/// The bytes of a JPEG file; `jpeg_quality` 1..100.
Result<std::string> encode_jpeg(const ColorImage& image, int jpeg_quality);

/// Writes a 16-bit PNG of round(metres * depth_scale). What is not positive and finite, or does not
/// fit below 65535, becomes 0.
Status save_depth(const std::filesystem::path& path, const DepthImage& image, double depth_scale);

/// Writes an 8-bit PNG without colour, such as a mask.
Status save_gray(const std::filesystem::path& path, const GrayImage& image);

}  // namespace sgs::io
