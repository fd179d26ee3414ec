// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapfile/view_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "sgs/camera/pyramid.h"
#include "sgs/core/archive.h"
#include "sgs/geometry/archive_se3.h"
#include "sgs/mapfile/archive_camera.h"

namespace sgs::mapfile {
namespace {

using Bytes = std::vector<std::uint8_t>;

// limit: side of the views in a map file, pixels
constexpr int kMostPixels = 16384;

constexpr float kUnitsPerMetre = 5000;

/// What is kept of a frame, three bytes a pixel: grey values, and depth in steps of a fifth of a
/// millimetre up to 13 m; 0: none.
struct Pixels {
  bool all_seen = true;  // else a grey value of 0 stands for what was not seen
  Image<std::uint8_t> gray;
  Image<std::uint16_t> depth;
};

Pixels pixels_of(const RgbdFrame& frame) {
  const PinholeCamera& camera = frame.camera;
  Pixels out{!frame.seen, Image<std::uint8_t>(camera.width, camera.height),
             Image<std::uint16_t>(camera.width, camera.height)};
  GrayPyramid picture;
  picture.build(frame.color, camera, 1, frame.seen.get());
  for (std::size_t i = 0; i < out.gray.size(); ++i) {
    const float gray = picture.level(0).gray.data()[i];  // not a number where nothing was seen
    const float least = out.all_seen ? 0.0f : 1.0f;
    if (gray >= 0)
      out.gray.data()[i] = static_cast<std::uint8_t>(std::lround(std::max(least, gray)));
    const float units = std::round(frame.depth.data()[i] * kUnitsPerMetre);
    if (units < 65536) out.depth.data()[i] = static_cast<std::uint16_t>(units);
  }
  return out;
}

void show(const Pixels& pixels, RgbdFrame& frame) {
  frame.color = ColorImage(frame.camera.width, frame.camera.height);
  frame.depth = DepthImage(frame.camera.width, frame.camera.height);
  PixelMask seen(frame.camera.width, frame.camera.height);
  for (std::size_t i = 0; i < pixels.gray.size(); ++i) {
    const std::uint8_t g = pixels.gray.data()[i];
    frame.color.data()[i] = {g, g, g};
    frame.depth.data()[i] = static_cast<float>(pixels.depth.data()[i]) / kUnitsPerMetre;
    seen.data()[i] = g > 0 ? 1 : 0;
  }
  if (!pixels.all_seen) frame.seen = std::make_shared<const PixelMask>(std::move(seen));
}

int expected_gray(const Image<std::uint8_t>& gray, int u, int v) {
  const int left = u > 0 ? gray(u - 1, v) : 0, above = v > 0 ? gray(u, v - 1) : 0;
  return u == 0 ? above : v == 0 ? left : (left + above) / 2;
}

Bytes pack_gray(const Image<std::uint8_t>& gray) {
  Bytes out;
  out.reserve(gray.size());
  for (int v = 0; v < gray.height(); ++v) {
    for (int u = 0; u < gray.width(); ++u) {
      out.push_back(static_cast<std::uint8_t>(gray(u, v) - expected_gray(gray, u, v)));
    }
  }
  return out;
}

void unpack_gray(const Bytes& bytes, Image<std::uint8_t>& gray) {
  std::size_t i = 0;
  for (int v = 0; v < gray.height(); ++v) {
    for (int u = 0; u < gray.width(); ++u) {
      gray(u, v) = static_cast<std::uint8_t>(bytes[i++] + expected_gray(gray, u, v));
    }
  }
}

/// Small differences of either sign as small numbers.
std::uint16_t folded(std::uint16_t difference) {
  const bool negative = difference >= 0x8000;
  const auto twice = static_cast<std::uint16_t>(difference << 1);
  return negative ? static_cast<std::uint16_t>(~twice) : twice;
}
std::uint16_t unfolded(std::uint16_t number) {
  const auto half = static_cast<std::uint16_t>(number >> 1);
  return (number & 1) != 0 ? static_cast<std::uint16_t>(~half) : half;
}

/// Low bytes, then high ones.
Bytes pack_depth(const Image<std::uint16_t>& depth) {
  Bytes out(2 * depth.size());
  std::uint16_t last = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const std::uint16_t d = depth.data()[i];
    const std::uint16_t number = folded(static_cast<std::uint16_t>(d - last));
    out[i] = static_cast<std::uint8_t>(number & 0xff);
    out[depth.size() + i] = static_cast<std::uint8_t>(number >> 8);
    last = d;
  }
  return out;
}

void unpack_depth(const Bytes& bytes, Image<std::uint16_t>& depth) {
  std::uint16_t last = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const auto number = static_cast<std::uint16_t>(bytes[i] | (bytes[depth.size() + i] << 8));
    last = static_cast<std::uint16_t>(last + unfolded(number));
    depth.data()[i] = last;
  }
}

/// Everything but the pixels.
template <class Archive>
void archive_rest(Archive& a, alignment::KnownView& view, bool& all_seen) {
  a(view.timestamp_s, view.T_world_camera, view.motion.readout, view.motion.velocity,
    view.motion.depth_delay_s, view.ferns, view.fern_seed);
  a(view.frame.camera, view.frame.index, view.frame.timestamp_s, all_seen);
}

bool makes_sense(const alignment::KnownView& view) {
  const PinholeCamera& camera = view.frame.camera;
  return camera.valid() && camera.width <= kMostPixels && camera.height <= kMostPixels &&
         view.T_world_camera.all_finite() && view.motion.readout.allFinite() &&
         view.motion.velocity.allFinite();
}

}  // namespace

std::string view_bytes(const alignment::KnownView& view) {
  alignment::KnownView rest = view;
  Pixels pixels = pixels_of(view.frame);
  ArchiveWriter archive;
  archive_rest(archive, rest, pixels.all_seen);
  Bytes gray = pack_gray(pixels.gray), depth = pack_depth(pixels.depth);
  archive(gray, depth);
  return archive.take();
}

std::optional<alignment::KnownView> view_from(std::string_view bytes) {
  alignment::KnownView view;
  Pixels pixels;
  ArchiveReader archive(bytes);
  archive_rest(archive, view, pixels.all_seen);
  Bytes gray, depth;
  archive(gray, depth);
  if (!archive.complete() || !makes_sense(view)) return std::nullopt;
  const PinholeCamera& camera = view.frame.camera;
  const auto size =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  if (gray.size() != size || depth.size() != 2 * size) return std::nullopt;
  pixels.gray = Image<std::uint8_t>(camera.width, camera.height);
  pixels.depth = Image<std::uint16_t>(camera.width, camera.height);
  unpack_gray(gray, pixels.gray);
  unpack_depth(depth, pixels.depth);
  show(pixels, view.frame);
  return view;
}

}  // namespace sgs::mapfile
