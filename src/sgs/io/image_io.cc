// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/image_io.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "sgs/io/atomic_file.h"
#include "sgs/io/image_decoder.h"
#include "sgs/io/image_stream.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

constexpr std::uint16_t kRawSaturated = 65535;
// limit: file of an image, bytes
constexpr std::int64_t kLargestImageFile_bytes = std::int64_t{256} << 20;
// limit: image as its header announces it, pixels
constexpr std::int64_t kLargestImage_px = 100'000'000;

/// The library never prints; OpenCV's encoders would.
void silence_opencv() {
  static const bool done = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return true;
  }();
  static_cast<void>(done);
}

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
    return fail(ErrorCode::kUnsupported, fmt::format("{}: neither PNG nor JPEG", name),
                "convert the images to PNG or JPEG");
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

/// Empty when OpenCV cannot encode the image.
std::vector<unsigned char> encode(const char* extension, const cv::Mat& image,
                                  const std::vector<int>& parameters) {
  silence_opencv();
  std::vector<unsigned char> bytes;
  try {
    if (!cv::imencode(extension, image, bytes, parameters)) bytes.clear();
  } catch (const cv::Exception&) {
    bytes.clear();
  }
  return bytes;
}

cv::Mat to_bgr(const ColorImage& image) {
  cv::Mat bgr(image.height(), image.width(), CV_8UC3);
  for (int y = 0; y < image.height(); ++y) {
    auto* out = bgr.ptr<cv::Vec3b>(y);
    const Rgb8* in = image.row(y);
    for (int x = 0; x < image.width(); ++x) out[x] = {in[x].b, in[x].g, in[x].r};
  }
  return bgr;
}

Status encode_and_write(const fs::path& path, const char* extension, const cv::Mat& image,
                        const std::vector<int>& parameters) {
  const auto bytes = encode(extension, image, parameters);
  if (bytes.empty()) {
    return fail(ErrorCode::kIo, fmt::format("{}: the image cannot be encoded", path.string()));
  }
  // One of many, written while a camera runs: waiting for the disk would cost frames.
  return write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                    Durability::kRelaxed);
}

}  // namespace

Result<ColorImage> decode_color(std::string bytes, const std::string& name) {
  SGS_ASSIGN_OR_RETURN(const Encoded encoded, checked_stream(std::move(bytes), name));
  if (encoded.check.bits_per_channel > 8) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: {} bits per channel where an 8-bit colour image is needed", name,
                            encoded.check.bits_per_channel),
                "are colour and depth swapped?");
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
  std::transform(raw.data(), raw.data() + raw.size(), image.data(), [&](std::uint16_t value) {
    return value == kRawSaturated ? 0.0f : static_cast<float>(value / depth_scale);
  });
  return image;
}

Result<DepthImage> decode_depth(std::string bytes, const std::string& name, double depth_scale) {
  SGS_ASSIGN_OR_RETURN(const RawDepth raw, decode_raw_depth(std::move(bytes), name));
  return depth_in_metres(raw, depth_scale);
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
  const cv::Mat bgr = to_bgr(image);
  return jpeg ? encode_and_write(path, ".jpg", bgr, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality})
              : encode_and_write(path, ".png", bgr, {cv::IMWRITE_PNG_COMPRESSION, 3});
}

Result<std::string> encode_jpeg(const ColorImage& image, int jpeg_quality) {
  SGS_CHECK(jpeg_quality >= 1 && jpeg_quality <= 100, "JPEG quality must be 1..100");
  SGS_CHECK(!image.empty(), "an empty image cannot be encoded");
  const auto bytes = encode(".jpg", to_bgr(image), {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
  if (bytes.empty()) return fail(ErrorCode::kIo, "the picture cannot be encoded as JPEG");
  return std::string(bytes.begin(), bytes.end());
}

Status save_depth(const fs::path& path, const DepthImage& image, double depth_scale) {
  SGS_CHECK(depth_scale > 0 && std::isfinite(depth_scale), "depth scale must be positive");
  SGS_CHECK(!image.empty(), "an empty image cannot be written");
  cv::Mat raw(image.height(), image.width(), CV_16UC1);
  for (int y = 0; y < image.height(); ++y) {
    auto* out = raw.ptr<std::uint16_t>(y);
    const float* in = image.row(y);
    for (int x = 0; x < image.width(); ++x) {
      const double value = std::round(static_cast<double>(in[x]) * depth_scale);
      const bool fits = value > 0 && value < kRawSaturated;  // false for NaN too
      out[x] = fits ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
  }
  return encode_and_write(path, ".png", raw, {cv::IMWRITE_PNG_COMPRESSION, 3});
}

}  // namespace sgs::io
