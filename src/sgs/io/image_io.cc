// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/image_io.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "sgs/io/atomic_file.h"
#include "sgs/io/foreign_content.h"
#include "sgs/io/image_decoder.h"
#include "sgs/io/image_encoder.h"
#include "sgs/io/image_stream.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

constexpr std::uint16_t kRawSaturated = 65535;
// limit: file of an image, bytes
constexpr std::int64_t kLargestImageFile_bytes = std::int64_t{256} << 20;
// limit: image as its header announces it, pixels
constexpr std::int64_t kLargestImage_px = 100'000'000;

struct Encoded {
  std::string bytes;
  StreamCheck check;
};

Result<Encoded> checked_stream(std::string bytes, const std::string& name) {
  Encoded encoded{std::move(bytes), {}};
  encoded.check = check_image_stream(encoded.bytes);
  if (!encoded.check.problem.empty()) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", name, encoded.check.problem),
                "copy or record the image again");
  }
  if (encoded.check.kind == StreamCheck::Kind::kUnknown) {
    const auto foreign = foreign_content(encoded.bytes);
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: {}", name, foreign ? foreign->what : "neither PNG nor JPEG"),
                foreign ? foreign->remedy : "convert the images to PNG or JPEG");
  }
  // A few hundred kilobytes can announce gigabytes of pixels.
  const std::int64_t pixels = std::int64_t{encoded.check.width} * encoded.check.height;
  if (pixels > kLargestImage_px) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: {}x{} pixels, more than {} million", name, encoded.check.width,
                            encoded.check.height, kLargestImage_px / 1'000'000),
                "reduce the images");
  }
  return encoded;
}

/// Puts the file's name before the message of a decoder.
tl::unexpected<Error> named(const std::string& name, Error error) {
  error.message = fmt::format("{}: {}", name, error.message);
  return tl::unexpected(std::move(error));
}

Status write_encoded(const fs::path& path, const Result<std::string>& bytes) {
  if (!bytes) return named(path.string(), bytes.error());
  // One of many, written while a camera runs: waiting for the disk would cost frames.
  return write_file(path, *bytes, Durability::kRelaxed);
}

}  // namespace

Result<ColorImage> decode_color(std::string bytes, const std::string& name) {
  SGS_ASSIGN_OR_RETURN(const Encoded encoded, checked_stream(std::move(bytes), name));
  if (encoded.check.bits_per_channel > 8) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: {} bits per channel where an 8-bit colour image is needed", name,
                            encoded.check.bits_per_channel),
                "are colour and depth swapped? Else convert the images to 8 bits per channel");
  }
  auto image = encoded.check.kind == StreamCheck::Kind::kJpeg ? decode_jpeg(encoded.bytes)
                                                              : decode_png_color(encoded.bytes);
  if (!image) return named(name, image.error());
  return image;
}

Result<RawDepth> decode_raw_depth(std::string bytes, const std::string& name) {
  SGS_ASSIGN_OR_RETURN(const Encoded encoded, checked_stream(std::move(bytes), name));
  if (encoded.check.kind == StreamCheck::Kind::kJpeg || encoded.check.bits_per_channel != 16) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: {}-bit {} where 16-bit PNG depth is needed", name,
                            encoded.check.bits_per_channel,
                            encoded.check.kind == StreamCheck::Kind::kJpeg ? "JPEG" : "PNG"),
                "export raw depth as single-channel 16-bit PNG, not as a preview picture");
  }
  auto raw = decode_png_grey16(encoded.bytes);
  if (!raw) return named(name, raw.error());
  return raw;
}

DepthImage depth_in_metres(const RawDepth& raw, double depth_scale) {
  SGS_CHECK(depth_scale > 0 && std::isfinite(depth_scale), "depth scale must be positive");
  DepthImage image(raw.width(), raw.height());
  const auto convert = [&](auto scale) {
    std::transform(raw.data(), raw.data() + raw.size(), image.data(), [=](std::uint16_t value) {
      return value == kRawSaturated ? 0.0f : static_cast<float>(value / scale);
    });
  };
  // A quotient of floats that is rounded to double first and to float then is the one that is
  // rounded to float at once (double has more than twice the digits), so the quick division gives
  // the same.
  const auto short_scale = static_cast<float>(depth_scale);
  if (static_cast<double>(short_scale) == depth_scale) {
    convert(short_scale);
  } else {
    convert(depth_scale);
  }
  return image;
}

Result<DepthImage> decode_depth(std::string bytes, const std::string& name, double depth_scale) {
  SGS_ASSIGN_OR_RETURN(const RawDepth raw, decode_raw_depth(std::move(bytes), name));
  return depth_in_metres(raw, depth_scale);
}

int viewer_orientation(const fs::path& path) {
  const auto bytes = read_file(path, kLargestImageFile_bytes);
  return bytes ? check_image_stream(*bytes).orientation : 1;
}

Result<ColorImage> load_color(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(std::string bytes, read_file(path, kLargestImageFile_bytes));
  return decode_color(std::move(bytes), path.string());
}

Result<DepthImage> load_depth(const fs::path& path, double depth_scale) {
  SGS_ASSIGN_OR_RETURN(std::string bytes, read_file(path, kLargestImageFile_bytes));
  return decode_depth(std::move(bytes), path.string(), depth_scale);
}

Result<RawDepth> load_raw_depth(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(std::string bytes, read_file(path, kLargestImageFile_bytes));
  return decode_raw_depth(std::move(bytes), path.string());
}

Result<GrayImage> load_gray(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const ColorImage color, load_color(path));
  GrayImage image(color.width(), color.height());
  for (std::size_t i = 0; i < color.size(); ++i) {
    const Rgb8& pixel = color.data()[i];
    if (pixel.r != pixel.g || pixel.r != pixel.b) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("{}: in colour where a grey image is needed", path.string()));
    }
    image.data()[i] = pixel.r;
  }
  return image;
}

Status save_color(const fs::path& path, const ColorImage& image, int jpeg_quality) {
  SGS_CHECK(jpeg_quality >= 1 && jpeg_quality <= 100, "JPEG quality must be 1..100");
  SGS_CHECK(!image.empty(), "an empty image cannot be written");
  const std::string extension = path.extension().string();
  const bool jpeg = extension == ".jpg" || extension == ".jpeg";
  if (!jpeg && extension != ".png") {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: unknown image extension '{}'", path.string(), extension),
                "use .png, .jpg or .jpeg");
  }
  return write_encoded(path,
                       jpeg ? encode_jpeg_color(image, jpeg_quality) : encode_png_color(image));
}

Result<std::string> encode_jpeg(const ColorImage& image, int jpeg_quality) {
  return encode_jpeg_color(image, jpeg_quality);
}

Status save_depth(const fs::path& path, const DepthImage& image, double depth_scale) {
  SGS_CHECK(depth_scale > 0 && std::isfinite(depth_scale), "depth scale must be positive");
  SGS_CHECK(!image.empty(), "an empty image cannot be written");
  RawDepth raw(image.width(), image.height());
  std::transform(image.data(), image.data() + image.size(), raw.data(), [&](float z) {
    const double value = std::round(static_cast<double>(z) * depth_scale);
    const bool fits = value > 0 && value < kRawSaturated;  // false for NaN too
    return fits ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
  });
  return write_encoded(path, encode_png_grey16(raw));
}

Status save_gray(const fs::path& path, const GrayImage& image) {
  SGS_CHECK(!image.empty(), "an empty image cannot be written");
  return write_encoded(path, encode_png_grey8(image));
}

}  // namespace sgs::io
