// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/splat_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "sgs/io/atomic_file.h"
#include "sgs/io/splat_check.h"

namespace sgs::io {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they are");

struct Record {
  float position[3];
  float scale[3];
  std::uint8_t rgba[4];
  std::uint8_t rotation[4];
};
static_assert(sizeof(Record) == kSplatRecordBytes);

std::uint8_t byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

std::string splat_records(std::span<const map::Gaussian> splats) {
  std::string out(splats.size() * sizeof(Record), '\0');
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const map::Gaussian& g = splats[i];
    Record record{};
    const auto q = unit_rotation(g);
    for (int k = 0; k < 3; ++k) {
      record.position[k] = g.mean[k];
      record.scale[k] = std::exp(g.log_scale[k]);
      record.rgba[k] = byte(255.0 * g.rgb[k]);
    }
    record.rgba[3] = byte(255 * map::opacity<double>(g));
    for (std::size_t k = 0; k < 4; ++k) record.rotation[k] = byte(128 + 128 * q[k]);
    std::memcpy(out.data() + i * sizeof record, &record, sizeof record);
  }
  return out;
}

std::string harmonic_records(const map::Harmonics& harmonics) {
  constexpr std::size_t kMultiple = 16;
  const std::size_t floats = harmonics.floats();
  const std::size_t stride = (floats + kMultiple - 1) / kMultiple * kMultiple;
  std::string out(stride * harmonics.size(), static_cast<char>(128));
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    const auto coefficients = harmonics.of(i);
    for (std::size_t k = 0; k < floats; ++k) {
      out[i * stride + k] = static_cast<char>(byte(128 + 128 * double{coefficients[k]}));
    }
  }
  return out;
}

std::vector<map::Gaussian> splats_from_records(std::string_view records) {
  SGS_CHECK(records.size() % sizeof(Record) == 0, "records are 32 bytes each");
  std::vector<map::Gaussian> splats(records.size() / sizeof(Record));
  for (std::size_t i = 0; i < splats.size(); ++i) {
    Record record{};
    std::memcpy(&record, records.data() + i * sizeof record, sizeof record);
    map::Gaussian& g = splats[i];
    for (int k = 0; k < 3; ++k) {
      g.mean[k] = record.position[k];
      g.log_scale[k] = std::log(record.scale[k]);
      g.rgb[k] = static_cast<float>(record.rgba[k]) / 255;
    }
    g.opacity_logit = opacity_logit(record.rgba[3] / 255.0);
    for (int k = 0; k < 4; ++k) {
      g.rotation[k] = (static_cast<float>(record.rotation[k]) - 128) / 128;
    }
  }
  return splats;
}

Status save_splat_file(const std::filesystem::path& path, std::span<const map::Gaussian> splats) {
  SGS_RETURN_IF_ERROR(check_splats(path, splats));
  return write_file(path, splat_records(splats));
}

}  // namespace sgs::io
