// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapfile/view_bytes.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sgs/core/archive.h"
#include "sgs/geometry/archive_se3.h"
#include "sgs/mapfile/archive_camera.h"

namespace sgs::mapfile {
namespace {

using Bytes = std::vector<std::uint8_t>;

// limit: side of the views in a map file, pixels
constexpr int kMostPixels = 16384;

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
void archive_rest(Archive& a, tracker::KnownView& view, CompactView::Parts& parts) {
  a(view.timestamp_s, view.T_world_camera, view.motion.readout, view.motion.velocity,
    view.motion.depth_delay_s, view.ferns, view.fern_seed);
  a(parts.camera, parts.index, parts.timestamp_s, parts.all_seen);
}

bool makes_sense(const tracker::KnownView& view, const PinholeCamera& camera) {
  return camera.valid() && camera.width <= kMostPixels && camera.height <= kMostPixels &&
         view.T_world_camera.all_finite() && view.motion.readout.allFinite() &&
         view.motion.velocity.allFinite();
}

}  // namespace

std::string view_bytes(const tracker::KnownView& view) {
  tracker::KnownView rest = view;
  CompactView::Parts parts = view.view.parts();
  ArchiveWriter archive;
  archive_rest(archive, rest, parts);
  Bytes gray = pack_gray(parts.gray), depth = pack_depth(parts.depth);
  archive(gray, depth);
  return archive.take();
}

std::optional<tracker::KnownView> view_from(std::string_view bytes) {
  tracker::KnownView view;
  CompactView::Parts parts;
  ArchiveReader archive(bytes);
  archive_rest(archive, view, parts);
  Bytes gray, depth;
  archive(gray, depth);
  if (!archive.complete() || !makes_sense(view, parts.camera)) return std::nullopt;
  const auto pixels =
      static_cast<std::size_t>(parts.camera.width) * static_cast<std::size_t>(parts.camera.height);
  if (gray.size() != pixels || depth.size() != 2 * pixels) return std::nullopt;
  parts.gray = Image<std::uint8_t>(parts.camera.width, parts.camera.height);
  parts.depth = Image<std::uint16_t>(parts.camera.width, parts.camera.height);
  unpack_gray(gray, parts.gray);
  unpack_depth(depth, parts.depth);
  view.view = CompactView(std::move(parts));
  return view;
}

}  // namespace sgs::mapfile
