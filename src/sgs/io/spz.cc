// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/spz.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "sgs/io/atomic_file.h"
#include "sgs/io/gzip.h"
#include "sgs/io/splat_check.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "the header is copied as it is");

struct Header {
  std::uint32_t magic = 0x5053474e;  // "NGSP"
  std::uint32_t version = 2;
  std::uint32_t count = 0;
  std::uint8_t sh_degree = 0, fractional_bits = 0, flags = 0, reserved = 0;
};
static_assert(sizeof(Header) == 16);

constexpr std::size_t kBytesPerSplat = 9 + 1 + 3 + 3 + 3;
constexpr int kMaxFractionalBits = 16;
constexpr double kLargestFixed = (1 << 23) - 1;
/// The same turn for the harmonics, basis function by basis function: odd in y or z, but not in
/// both.
constexpr std::array<double, map::Harmonics::basis_functions(map::kMaxHarmonicDegree)>
    kHarmonicSigns = {-1, -1, 1, -1, 1, 1, -1, 1, -1, 1, -1, -1, 1, -1, 1};
constexpr double kHarmonicScale = 128;
constexpr double kColorScale = 0.15;  // of the SH coefficient, so that out-of-range colours fit
/// Right-down-forward to right-up-back: signs of the axes, and of the quaternion's vector part.
constexpr std::array<double, 3> kSigns = {1, -1, -1};

char byte_char(double value) {
  return static_cast<char>(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))));
}
double value_of(char c) { return static_cast<double>(static_cast<std::uint8_t>(c)); }

/// Fractional bits that leave room for the largest coordinate; negative: it does not fit.
int fractional_bits(std::span<const map::Gaussian> splats) {
  double largest = 0;
  for (const map::Gaussian& g : splats) {
    for (const float v : g.mean) largest = std::max(largest, std::abs(static_cast<double>(v)));
  }
  int bits = kMaxFractionalBits;
  while (bits >= 0 && std::ldexp(largest, bits) > kLargestFixed) --bits;
  return bits;
}

void append_position(std::string& out, const map::Gaussian& g, int bits) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto fixed =
        static_cast<std::int32_t>(std::lround(std::ldexp(kSigns[k] * g.mean[k], bits)));
    for (int shift = 0; shift < 24; shift += 8) out += static_cast<char>(fixed >> shift & 0xFF);
  }
}

double position_of(const char* at, int bits) {
  std::uint32_t fixed = 0;
  for (int i = 0; i < 3; ++i) fixed |= static_cast<std::uint32_t>(value_of(at[i])) << (8 * i);
  if (fixed & 0x800000) fixed |= 0xFF000000;
  return std::ldexp(static_cast<double>(static_cast<std::int32_t>(fixed)), -bits);
}

/// A half turn about one of its own axes leaves an ellipsoid as it is. Of the four rotations that
/// differ by them, the one with the largest w: w is not stored, and computing it from 8-bit x y z
/// is precise only when it is large.
std::array<double, 4> largest_w(const std::array<double, 4>& q) {
  const std::array<std::array<double, 4>, 4> equal = {
      q, {{-q[1], q[0], q[3], -q[2]}}, {{-q[2], -q[3], q[0], q[1]}}, {{-q[3], q[2], -q[1], q[0]}}};
  return *std::max_element(equal.begin(), equal.end(), [](const auto& a, const auto& b) {
    return std::abs(a[0]) < std::abs(b[0]);
  });
}

void append_rotation(std::string& out, const map::Gaussian& g) {
  const auto q = largest_w(unit_rotation(g));
  const double sign = q[0] < 0 ? -1 : 1;
  for (std::size_t k = 0; k < 3; ++k) out += byte_char(127.5 + 127.5 * sign * kSigns[k] * q[k + 1]);
}

void set_rotation(map::Gaussian& g, const char* at) {
  double squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double q = value_of(at[k]) / 127.5 - 1;
    g.rotation[k + 1] = static_cast<float>(kSigns[k] * q);
    squares += q * q;
  }
  g.rotation[0] = static_cast<float>(std::sqrt(std::max(0.0, 1 - squares)));
}

tl::unexpected<Error> bad_file(const fs::path& path, const std::string& what) {
  return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", path.string(), what),
              "needed: an SPZ file of version 2");
}

}  // namespace

Status save_spz(const fs::path& path, std::span<const map::Gaussian> splats,
                const map::Harmonics& harmonics) {
  SGS_RETURN_IF_ERROR(check_splats(path, splats, harmonics));
  const int bits = fractional_bits(splats);
  if (bits < 0) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: coordinates beyond 8388 km do not fit", path.string()));
  }
  Header header;
  header.count = static_cast<std::uint32_t>(splats.size());
  header.fractional_bits = static_cast<std::uint8_t>(bits);
  header.sh_degree = static_cast<std::uint8_t>(harmonics.degree);
  std::string out(sizeof header, '\0');
  std::memcpy(out.data(), &header, sizeof header);
  out.reserve(out.size() + (kBytesPerSplat + harmonics.floats()) * splats.size());
  for (const map::Gaussian& g : splats) append_position(out, g, bits);
  for (const map::Gaussian& g : splats) out += byte_char(255 * map::opacity<double>(g));
  for (const map::Gaussian& g : splats) {
    for (const float c : g.rgb) out += byte_char(255 * (0.5 + kColorScale * (c - 0.5) / kSh0));
  }
  for (const map::Gaussian& g : splats) {
    for (const float s : g.log_scale) out += byte_char(16 * (s + 10.0));
  }
  for (const map::Gaussian& g : splats) append_rotation(out, g);
  for (std::size_t i = 0; i < harmonics.coefficients.size(); ++i) {
    const std::size_t function = i % harmonics.floats() / 3;
    out += byte_char(kHarmonicScale *
                     (1 + kHarmonicSigns[function] * double{harmonics.coefficients[i]}));
  }
  return write_file(path, gzip_compressed(out));
}

Result<map::SplatMap> load_spz(const fs::path& path) {
  // limit: SPZ after decompression, bytes
  constexpr std::size_t kMaxBytes = std::size_t{1} << 31;
  SGS_ASSIGN_OR_RETURN(const std::string stream, read_file(path));
  const auto content = gzip_decompressed(stream, kMaxBytes);
  if (!content) return bad_file(path, "not a whole gzip stream");
  Header header;
  if (content->size() < sizeof header) return bad_file(path, "truncated header");
  std::memcpy(&header, content->data(), sizeof header);
  if (header.magic != Header{}.magic) return bad_file(path, "no SPZ header");
  if (header.version != Header{}.version || header.sh_degree > map::kMaxHarmonicDegree ||
      header.fractional_bits > 23) {
    return bad_file(path, fmt::format("version {}, SH degree {}, {} fractional bits",
                                      header.version, header.sh_degree, header.fractional_bits));
  }
  const std::size_t n = header.count;
  map::SplatMap splats{{}, {header.sh_degree, {}}};
  const std::size_t floats = splats.harmonics.floats();
  if (content->size() != sizeof header + (kBytesPerSplat + floats) * n) {
    return bad_file(path, fmt::format("{} bytes for {} Gaussians", content->size(), n));
  }
  const char* positions = content->data() + sizeof header;
  const char* alphas = positions + 9 * n;
  const char* colors = alphas + n;
  const char* scales = colors + 3 * n;
  const char* rotations = scales + 3 * n;
  splats.gaussians.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    map::Gaussian& g = splats.gaussians[i];
    for (std::size_t k = 0; k < 3; ++k) {
      g.mean[k] = static_cast<float>(
          kSigns[k] * position_of(positions + 9 * i + 3 * k, header.fractional_bits));
      g.rgb[k] =
          static_cast<float>(0.5 + kSh0 * (value_of(colors[3 * i + k]) / 255 - 0.5) / kColorScale);
      g.log_scale[k] = static_cast<float>(value_of(scales[3 * i + k]) / 16 - 10);
    }
    g.opacity_logit = opacity_logit(value_of(alphas[i]) / 255);
    set_rotation(g, rotations + 3 * i);
  }
  const char* rest = rotations + 3 * n;
  splats.harmonics.resize(n);
  for (std::size_t i = 0; i < floats * n; ++i) {
    splats.harmonics.coefficients[i] = static_cast<float>(kHarmonicSigns[i % floats / 3] *
                                                          (value_of(rest[i]) / kHarmonicScale - 1));
  }
  return splats;
}

}  // namespace sgs::io
