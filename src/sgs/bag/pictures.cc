// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/pictures.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "sgs/bag/bytes.h"
#include "sgs/camera/opencv_threads.h"
#include "sgs/io/image_io.h"
#include "sgs/io/text.h"

namespace sgs::bag {
namespace {

constexpr std::uint16_t kNoDepth = 65535;
constexpr std::uint64_t kLargestPicture_px = 100'000'000;

/// A colour encoding in small letters: its OpenCV type and how it becomes red green blue; -1 = it
/// already is.
struct ColorEncoding {
  const char* name;
  int type;
  int conversion;
};

constexpr ColorEncoding kColorEncodings[] = {
    {"rgb8", CV_8UC3, -1},
    {"bgr8", CV_8UC3, cv::COLOR_BGR2RGB},
    {"8uc3", CV_8UC3, cv::COLOR_BGR2RGB},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2RGB},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2RGB},
    {"8uc4", CV_8UC4, cv::COLOR_BGRA2RGB},
    {"mono8", CV_8UC1, cv::COLOR_GRAY2RGB},
    {"8uc1", CV_8UC1, cv::COLOR_GRAY2RGB},
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2RGB},  // OpenCV names the second row's pixels
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2RGB},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2RGB},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2RGB},
    {"mono16", CV_16UC1, cv::COLOR_GRAY2RGB},
    {"rgb16", CV_16UC3, -1},
    {"bgr16", CV_16UC3, cv::COLOR_BGR2RGB},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2RGB_UYVY},
    {"uyvy", CV_8UC2, cv::COLOR_YUV2RGB_UYVY},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2RGB_YUY2},
    {"yuyv", CV_8UC2, cv::COLOR_YUV2RGB_YUY2},
    {"yuy2", CV_8UC2, cv::COLOR_YUV2RGB_YUY2},
    {"nv12", CV_8UC1, cv::COLOR_YUV2RGB_NV12},
    {"nv21", CV_8UC1, cv::COLOR_YUV2RGB_NV21},
};

/// Whether the data are a JPEG stream.
bool is_jpeg(const ImageMessage& image) {
  const std::string name = io::lower_case(image.encoding);
  return name == "mjpg" || name == "mjpeg" || name == "jpeg";
}

/// Encodings of which each two rows of brightness share a row of colour, which lie behind all of
/// them.
bool has_colour_behind(const ColorEncoding& encoding) {
  return encoding.conversion == cv::COLOR_YUV2RGB_NV12 ||
         encoding.conversion == cv::COLOR_YUV2RGB_NV21;
}

/// The bytes from one row of `pixel_bytes` per pixel to the next: those that the message says, or
/// those of a row without gaps, where that is far too short and only these fit the data. Nothing is
/// allocated on the word of a header that does not fit them at all.
Result<std::size_t> row_step(const ImageMessage& image, std::uint64_t pixel_bytes) {
  const std::uint64_t row = pixel_bytes * image.width;
  const bool some = image.width > 0 && image.height > 0 &&
                    std::uint64_t{image.width} * image.height <= kLargestPicture_px;
  if (some && image.step >= row &&
      std::uint64_t{image.step} * (image.height - 1) + row <= image.data.size()) {
    return std::size_t{image.step};
  }
  const bool far_too_short = 2 * std::uint64_t{image.step} <= row;
  if (some && far_too_short && row * image.height == image.data.size()) {
    return static_cast<std::size_t>(row);
  }
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("an image of {}x{} {} with rows of {} bytes does not fit its {} bytes",
                          image.width, image.height, image.encoding, image.step, image.data.size()),
              "the recording is damaged");
}

/// The upper halves of 16-bit values.
cv::Mat upper_bytes(const cv::Mat& wide, bool big_endian) {
  cv::Mat out(wide.size(), CV_MAKETYPE(CV_8U, wide.channels()));
  for (int y = 0; y < wide.rows; ++y) {
    const auto* from = wide.ptr<std::uint8_t>(y) + (big_endian ? 0 : 1);
    auto* to = out.ptr<std::uint8_t>(y);
    for (int i = 0; i < wide.cols * wide.channels(); ++i) to[i] = from[2 * i];
  }
  return out;
}

template <class T>
T pixel(const char* from, bool swap) {
  char raw[sizeof(T)];
  std::memcpy(raw, from, sizeof(T));
  if (swap) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

/// The pixels of a raw image, turned into metres by `convert`.
template <class T, class Convert>
Result<DepthImage> convert_depth(const ImageMessage& image, bool other_order, Convert convert) {
  SGS_ASSIGN_OR_RETURN(const std::size_t step, row_step(image, sizeof(T)));
  static_assert(std::endian::native == std::endian::little);
  DepthImage out(static_cast<int>(image.width), static_cast<int>(image.height));
  for (int y = 0; y < out.height(); ++y) {
    const char* row = image.data.data() + step * static_cast<std::size_t>(y);
    for (int x = 0; x < out.width(); ++x) {
      out(x, y) = convert(
          pixel<T>(row + sizeof(T) * static_cast<std::size_t>(x), image.big_endian != other_order));
    }
  }
  return out;
}

float metres_of_raw(std::uint16_t raw, double units_per_metre) {
  return raw == kNoDepth ? 0.0f : static_cast<float>(raw / units_per_metre);
}

float metres_of_float(float value) { return std::isfinite(value) && value > 0 ? value : 0.0f; }

/// compressed_depth_image_transport: floats as 16-bit inverse depths, v = a / depth + b.
Result<DepthImage> decode_inverse_depth(std::string png, float a, float b) {
  SGS_ASSIGN_OR_RETURN(const auto raw, io::decode_raw_depth(std::move(png), "a compressed depth"));
  DepthImage out(raw.width(), raw.height());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const std::uint16_t v = raw.data()[i];
    if (v != 0) out.data()[i] = metres_of_float(a / (static_cast<float>(v) - b));
  }
  return out;
}

}  // namespace

DepthEncoding depth_encoding(const std::string& encoding) {
  const std::string name = io::lower_case(encoding);
  if (name == "16uc1" || name == "32fc1" || name == "z16") return DepthEncoding::kYes;
  const bool maybe = name == "mono16" || name == "y16" || name == "16sc1";
  return maybe ? DepthEncoding::kMaybe : DepthEncoding::kNo;
}

bool byte_order_contradicts(const ImageMessage& image) {
  // Of the two orders the wrong one makes noise of low bytes.
  constexpr double kMuchRougher = 8;
  const bool floats = io::lower_case(image.encoding) == "32fc1";
  if (depth_encoding(image.encoding) == DepthEncoding::kNo) return false;
  const auto roughness = [&](bool other_order) {
    const auto depth = decode_depth(image, {1, false, other_order});
    double sum = 0, differences = 0;
    for (int y = 0; depth && y < depth->height(); ++y) {
      for (int x = 1; x < depth->width(); ++x) {
        const auto a = static_cast<double>((*depth)(x - 1, y));
        const auto b = static_cast<double>((*depth)(x, y));
        if (a == 0 || b == 0) continue;
        // What floats of the wrong order hold is of any size.
        sum += floats ? 1 : a + b;
        differences += floats ? std::min(1.0, std::abs(a - b) / (a + b)) : std::abs(a - b);
      }
    }
    return sum > 0 ? differences / sum : std::numeric_limits<double>::infinity();
  };
  const double as_said = roughness(false), turned = roughness(true);
  return std::isfinite(turned) && as_said > kMuchRougher * turned;
}

bool row_length_contradicts(const ImageMessage& image) {
  if (is_jpeg(image)) return false;
  // Rows of colour behind those of brightness (NV12) add half as many.
  return image.height > 0 && 2 * std::uint64_t{image.step} * image.height <= image.data.size();
}

Result<ColorImage> decode_color(const ImageMessage& image) {
  const std::string name = io::lower_case(image.encoding);
  if (is_jpeg(image)) {
    return io::decode_color(std::string(image.data), "an image");
  }
  const auto* known = std::find_if(std::begin(kColorEncodings), std::end(kColorEncodings),
                                   [&](const ColorEncoding& e) { return name == e.name; });
  if (known == std::end(kColorEncodings)) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("colour encoding '{}' is not known", image.encoding),
                "record or convert it as rgb8, or choose another topic with --topics");
  }
  SGS_ASSIGN_OR_RETURN(const std::size_t step, row_step(image, CV_ELEM_SIZE(known->type)));
  const bool behind = has_colour_behind(*known), pairs = CV_MAT_CN(known->type) == 2 || behind;
  const std::uint64_t rows = image.height + (behind ? image.height / 2 : 0);
  const bool no_pattern = name.starts_with("bayer") && std::min(image.width, image.height) < 3;
  const bool odd = (pairs && image.width % 2 != 0) || (behind && image.height % 2 != 0);
  if (odd || no_pattern || std::uint64_t{step} * rows > image.data.size() + step - image.width) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{} of {}x{} does not fit its {} bytes", image.encoding, image.width,
                            image.height, image.data.size()),
                "record it as rgb8");
  }
  ColorImage out(static_cast<int>(image.width), static_cast<int>(image.height));
  // Only read; cv::Mat has no const view.
  cv::Mat in(static_cast<int>(rows), out.width(), known->type, const_cast<char*>(image.data.data()),
             step);
  if (CV_MAT_DEPTH(known->type) == CV_16U) in = upper_bytes(in, image.big_endian);
  cv::Mat rgb(out.height(), out.width(), CV_8UC3, out.data());
  if (known->conversion < 0) {
    in.copyTo(rgb);
  } else {
    keep_opencv_to_one_thread();
    cv::cvtColor(in, rgb, known->conversion);
  }
  return out;
}

Result<ColorImage> decode_color(const CompressedImageMessage& image) {
  return io::decode_color(std::string(image.data), "a compressed image");
}

Result<DepthImage> decode_depth(const ImageMessage& image, const DepthUnit& unit) {
  if (io::lower_case(image.encoding) == "32fc1") {
    const double scale = unit.scale_floats ? unit.units_per_metre : 1;
    return convert_depth<float>(image, unit.other_byte_order, [&](float value) {
      return scale == 1 ? metres_of_float(value)
                        : metres_of_float(static_cast<float>(value / scale));
    });
  }
  if (depth_encoding(image.encoding) != DepthEncoding::kNo) {
    return convert_depth<std::uint16_t>(image, unit.other_byte_order, [&](std::uint16_t raw) {
      return metres_of_raw(raw, unit.units_per_metre);
    });
  }
  return fail(
      ErrorCode::kUnsupported, fmt::format("depth encoding '{}' is not known", image.encoding),
      "is it the topic of colour? Record depth as 16UC1 (millimetres) or 32FC1 (metres), or "
      "choose another topic with --topics color=/TOPIC,depth=/TOPIC");
}

Result<DepthImage> decode_depth(const CompressedImageMessage& image, const DepthUnit& unit) {
  constexpr std::size_t kConfigBytes = 12;
  const bool transport = image.format.find("compressedDepth") != std::string::npos;
  if (!transport) {
    return io::decode_depth(std::string(image.data), "a compressed depth", unit.units_per_metre);
  }
  if (image.format.find("rvl") != std::string::npos) {
    return fail(ErrorCode::kUnsupported, "depth is packed with RVL",
                "record it with compressedDepth's format png, or raw");
  }
  Bytes config(image.data);
  config.number<std::int32_t>();
  const auto a = config.number<float>(), b = config.number<float>();
  if (!config.ok())
    return fail(ErrorCode::kInvalidFormat, "a compressed depth that is too short",
                "the recording is damaged");
  std::string png(image.data.substr(kConfigBytes));
  if (image.format.find("32FC1") != std::string::npos) {
    return decode_inverse_depth(std::move(png), a, b);
  }
  return io::decode_depth(std::move(png), "a compressed depth", unit.units_per_metre);
}

}  // namespace sgs::bag
