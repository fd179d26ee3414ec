// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/sens_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "sgs/dataset/rigid.h"
#include "sgs/io/gzip.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr const char* kDamaged = "the file is damaged; download or record it again";

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

using Floats = std::array<float, 16>;  // a 4x4, row by row

enum SensColor : std::int32_t { kColorRaw = 0, kColorPng = 1, kColorJpeg = 2 };
enum SensDepth : std::int32_t { kDepthRaw = 0, kDepthZlib = 1 };

constexpr std::uint32_t kSensVersion = 4;
constexpr std::uint32_t kLargestSide_px = 16384;
constexpr std::uint64_t kLargestPixels = 100'000'000;
constexpr std::uint64_t kLargestName_bytes = 4096;
constexpr std::uint64_t kLargestImage_bytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kFrameHeader_bytes = 64 + 4 * 8;

std::array<double, 16> widened(const Floats& values) {
  std::array<double, 16> out{};
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

bool plausible_size(std::uint32_t width, std::uint32_t height) {
  return width > 0 && height > 0 && width <= kLargestSide_px && height <= kLargestSide_px &&
         std::uint64_t{width} * height <= kLargestPixels;
}

PinholeCamera camera_of(const Floats& K, std::uint32_t width, std::uint32_t height) {
  return {static_cast<int>(width), static_cast<int>(height), K[0], K[5], K[2], K[6]};
}

bool is_identity_matrix(const Floats& m) {
  constexpr float kTolerance = 1e-4f;
  for (std::size_t i = 0; i < m.size(); ++i) {
    if (!(std::abs(m[i] - (i % 5 == 0 ? 1.0f : 0.0f)) < kTolerance)) return false;
  }
  return true;
}

}  // namespace

tl::unexpected<Error> SensFile::damaged(const std::string& what) const {
  return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", path_.string(), what),
              "download or copy the file again");
}

std::string SensFile::place(std::size_t frame, const char* what) const {
  return fmt::format("{}: {} of frame {}", path_.string(), what, frame);
}

template <class T>
bool SensFile::read(T& value) {
  return static_cast<bool>(file_.read(reinterpret_cast<char*>(&value), sizeof value));
}

std::optional<std::string> SensFile::read_bytes(std::uint64_t at, std::uint64_t count) {
  if (at > size_ || count > size_ - at) return std::nullopt;
  std::string bytes(count, '\0');
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(at));
  if (!file_.read(bytes.data(), static_cast<std::streamsize>(count))) return std::nullopt;
  return bytes;
}

Result<SensFile> SensFile::open(const fs::path& path) {
  SensFile sens(path);
  std::error_code error;
  sens.size_ = fs::file_size(path, error);
  sens.file_.open(path, std::ios::binary);
  if (error || !sens.file_) {
    return fail(ErrorCode::kIo, fmt::format("{}: cannot be read", path.string()),
                "check the file and its permissions");
  }
  SGS_RETURN_IF_ERROR(sens.read_header());
  sens.index_frames();
  if (sens.frames_.empty()) return sens.damaged("ends before its first frame is complete");
  return sens;
}

Status SensFile::read_header() {
  std::uint32_t version = 0;
  std::uint64_t name_bytes = 0;
  if (!read(version)) return damaged("too short for a ScanNet recording");
  if (version != kSensVersion) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: version {} of the format, or no ScanNet recording at all; version "
                            "{} can be read",
                            path_.string(), version, kSensVersion),
                "export it with ScanNet's reader and give that folder");
  }
  if (!read(name_bytes)) return damaged("ends in its header");
  if (name_bytes > kLargestName_bytes) {
    return damaged(fmt::format("a sensor's name of {} bytes cannot be", name_bytes));
  }
  sensor_.resize(name_bytes);
  if (!file_.read(sensor_.data(), static_cast<std::streamsize>(name_bytes))) {
    return damaged("ends in its header");
  }
  return read_cameras();
}

Status SensFile::read_cameras() {
  Floats color_K{}, color_pose{}, depth_K{}, depth_pose{};
  std::uint32_t color_width = 0, color_height = 0, depth_width = 0, depth_height = 0;
  float depth_shift = 0;
  const bool complete = read(color_K) && read(color_pose) && read(depth_K) && read(depth_pose) &&
                        read(color_coding_) && read(depth_coding_) && read(color_width) &&
                        read(color_height) && read(depth_width) && read(depth_height) &&
                        read(depth_shift) && read(announced_);
  if (!complete) return damaged("ends in its header");
  if (!plausible_size(color_width, color_height) || !plausible_size(depth_width, depth_height)) {
    return damaged(fmt::format("announces colour of {}x{} and depth of {}x{} pixels", color_width,
                               color_height, depth_width, depth_height));
  }
  if (color_coding_ < kColorRaw || color_coding_ > kColorJpeg) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: colour of unknown coding {}", path_.string(), color_coding_),
                "raw, PNG and JPEG can be read");
  }
  if (depth_coding_ != kDepthRaw && depth_coding_ != kDepthZlib) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: depth of coding {} ({})", path_.string(), depth_coding_,
                            depth_coding_ == 2 ? "occi" : "unknown"),
                "raw and zlib can be read; export it with ScanNet's reader and give that folder");
  }
  color_camera_ = camera_of(color_K, color_width, color_height);
  depth_camera_ = camera_of(depth_K, depth_width, depth_height);
  depth_scale_ = depth_shift;
  moved_cameras_ = !is_identity_matrix(color_pose) || !is_identity_matrix(depth_pose);
  return {};
}

// A file that is cut off keeps the frames that are whole.
void SensFile::index_frames() {
  auto at = static_cast<std::uint64_t>(file_.tellg());
  while (frames_.size() < announced_ && size_ - at >= kFrameHeader_bytes) {
    Frame frame;
    Floats pose{};
    file_.seekg(static_cast<std::streamoff>(at));
    if (!read(pose) || !read(frame.color_time_us) || !read(frame.depth_time_us) ||
        !read(frame.color_bytes) || !read(frame.depth_bytes)) {
      return;
    }
    frame.color_at = at + kFrameHeader_bytes;
    const std::uint64_t left = size_ - frame.color_at;
    if (frame.color_bytes > left || frame.depth_bytes > left - frame.color_bytes) return;
    frame.T_world_camera = rigid_from_rows(widened(pose));
    frames_.push_back(frame);
    at = frame.color_at + frame.color_bytes + frame.depth_bytes;
  }
}

Result<ColorImage> SensFile::color(std::size_t index) {
  const Frame& frame = frames_.at(index);
  const std::string name = place(index, "colour");
  if (frame.color_bytes > kLargestImage_bytes) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} bytes cannot be one image", name, frame.color_bytes), kDamaged);
  }
  const auto bytes = read_bytes(frame.color_at, frame.color_bytes);
  if (!bytes) return fail(ErrorCode::kIo, fmt::format("{}: cannot be read", name), kDamaged);
  if (color_coding_ != kColorRaw) return io::decode_color(*bytes, name);
  ColorImage image(color_camera_.width, color_camera_.height);
  if (bytes->size() != image.size() * sizeof(Rgb8)) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} bytes where {} make an image", name, bytes->size(),
                            image.size() * sizeof(Rgb8)),
                kDamaged);
  }
  for (std::size_t i = 0; i < image.size(); ++i) {
    const auto byte = [&](std::size_t k) { return static_cast<std::uint8_t>((*bytes)[3 * i + k]); };
    image.data()[i] = {byte(0), byte(1), byte(2)};
  }
  return image;
}

Result<io::RawDepth> SensFile::depth(std::size_t index) {
  const Frame& frame = frames_.at(index);
  const std::string name = place(index, "depth");
  const std::size_t size = static_cast<std::size_t>(depth_camera_.width) *
                           static_cast<std::size_t>(depth_camera_.height) * sizeof(std::uint16_t);
  // Deflate makes at most a few bytes more of what it cannot compress.
  const std::uint64_t largest = size + size / 100 + 1024;
  if (frame.depth_bytes > largest) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} bytes cannot be one image", name, frame.depth_bytes), kDamaged);
  }
  auto bytes = read_bytes(frame.color_at + frame.color_bytes, frame.depth_bytes);
  if (!bytes) return fail(ErrorCode::kIo, fmt::format("{}: cannot be read", name), kDamaged);
  if (depth_coding_ == kDepthZlib) bytes = io::zlib_decompressed(*bytes, size);
  if (!bytes || bytes->size() != size) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: damaged, or not of {} bytes", name, size), kDamaged);
  }
  io::RawDepth image(depth_camera_.width, depth_camera_.height);
  std::copy(bytes->begin(), bytes->end(), reinterpret_cast<char*>(image.data()));
  return image;
}

}  // namespace sgs::dataset
