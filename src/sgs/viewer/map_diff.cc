// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/map_diff.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "sgs/core/error.h"
#include "sgs/core/image.h"
#include "sgs/io/splat_file.h"

namespace sgs::viewer {
namespace {

static_assert(std::endian::native == std::endian::little, "records are sent as they lie in memory");

constexpr float kVisibleShare = 0.04f;       // of the largest standard deviation
constexpr float kVisibleRotation = 0.9995f;  // |q1 . q2|: about 3.6 degrees
constexpr int kVisibleColour = 2;
constexpr std::uint8_t kMapKind = 1, kResetFlag = 1, kLastFlag = 2;
constexpr std::size_t kHeaderBytes = 24;

bool visibly_different(const SplatRecord& a, const SplatRecord& b) {
  const float size = std::max({a.scale[0], a.scale[1], a.scale[2]});
  float dot = 0;
  for (int k = 0; k < 4; ++k) {
    if (std::abs(a.rgba[k] - b.rgba[k]) >= kVisibleColour) return true;
    dot += a.rotation[k] * b.rotation[k];
  }
  for (int k = 0; k < 3; ++k) {
    if (!(std::abs(a.position[k] - b.position[k]) <= kVisibleShare * size)) return true;
    if (!(std::abs(a.scale[k] - b.scale[k]) <= kVisibleShare * size)) return true;
  }
  return !(std::abs(dot) >= kVisibleRotation);
}

bool different(const SplatRecord& a, const SplatRecord& b, bool exact) {
  return exact ? std::memcmp(&a, &b, sizeof(a)) != 0 : visibly_different(a, b);
}

/// Whether bytes of harmonics differ by what is seen.
bool harmonics_differ(const char* a, const char* b, std::size_t size, bool exact) {
  constexpr int kVisible = 4;
  for (std::size_t k = 0; k < size; ++k) {
    const int difference = static_cast<unsigned char>(a[k]) - static_cast<unsigned char>(b[k]);
    if (std::abs(difference) >= (exact ? 1 : kVisible)) return true;
  }
  return false;
}

/// Ids as the snapshot gives them, or positions where those cannot be used.
struct Ids {
  explicit Ids(const map::Snapshot& snapshot) : anchors(snapshot.anchors) {
    stable = anchors.size() == snapshot.gaussians.size();
    for (std::size_t i = 1; stable && i < anchors.size(); ++i) {
      stable = anchors[i - 1].id < anchors[i].id;
    }
  }
  std::uint32_t operator[](std::size_t i) const {
    return stable ? anchors[i].id : static_cast<std::uint32_t>(i);
  }
  const std::vector<map::Anchor>& anchors;
  bool stable = true;
};

template <class T>
void append(std::string& out, const T& value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

}  // namespace

SplatRecord encode_splat(const map::Gaussian& g, std::uint32_t id) {
  SplatRecord r;
  r.id = id;
  float norm = 0;
  for (const float q : g.rotation) norm += q * q;
  norm = std::sqrt(norm);
  for (int k = 0; k < 3; ++k) {
    r.position[k] = g.mean[k];
    r.scale[k] = std::exp(g.log_scale[k]);
    r.rgba[k] = to_byte(g.rgb[k]);
  }
  for (int k = 0; k < 4; ++k) {
    r.rotation[k] = norm > 0 ? g.rotation[k] / norm : (k == 0 ? 1.0f : 0.0f);
  }
  r.rgba[3] = to_byte(map::opacity(g));
  return r;
}

MapStep map_step(const ClientMapPtr& from, const map::Snapshot& snapshot, bool exact) {
  const Ids ids(snapshot);
  MapStep step;
  step.reset = from == nullptr || !ids.stable || from->degree != snapshot.harmonics.degree;
  auto to = std::make_shared<ClientMap>();
  to->version = snapshot.version;
  to->records.reserve(snapshot.gaussians.size());
  to->degree = snapshot.harmonics.degree;
  to->harmonics = io::harmonic_records(snapshot.harmonics);
  const std::size_t stride =
      snapshot.gaussians.empty() ? 0 : to->harmonics.size() / snapshot.gaussians.size();
  static const std::vector<SplatRecord> kNothing;
  const auto& old = step.reset ? kNothing : from->records;
  std::size_t k = 0;
  for (std::size_t i = 0; i < snapshot.gaussians.size(); ++i) {
    const SplatRecord fresh = encode_splat(snapshot.gaussians[i], ids[i]);
    while (k < old.size() && old[k].id < fresh.id) step.removed.push_back(old[k++].id);
    const bool known = k < old.size() && old[k].id == fresh.id;
    char* colors = to->harmonics.data() + i * stride;
    const char* old_colors = known ? from->harmonics.data() + k * stride : nullptr;
    if (known && !different(old[k], fresh, exact) &&
        !harmonics_differ(old_colors, colors, stride, exact)) {
      to->records.push_back(old[k]);
      std::copy_n(old_colors, stride, colors);
    } else {
      step.changed.push_back(static_cast<std::uint32_t>(i));
      to->records.push_back(fresh);
    }
    k += known ? 1 : 0;
  }
  for (; k < old.size(); ++k) step.removed.push_back(old[k].id);
  step.to = std::move(to);
  return step;
}

std::size_t map_message_count(const MapStep& step) {
  // Four bytes an id: a message holds twelve times as many removals as records.
  const auto messages = [](std::size_t n, std::size_t per) { return (n + per - 1) / per; };
  return std::max<std::size_t>({1, messages(step.changed.size(), kMapMessageRecords),
                                messages(step.removed.size(), 12 * kMapMessageRecords)});
}

std::string map_message(const MapStep& step, std::size_t i) {
  const std::size_t count = map_message_count(step);
  SGS_CHECK(i < count, "no such message");
  const auto range = [i](std::size_t size, std::size_t per) {
    const std::size_t first = std::min(size, i * per);
    return std::pair{first, std::min(size, first + per)};
  };
  const auto [first, last] = range(step.changed.size(), kMapMessageRecords);
  const auto [first_gone, last_gone] = range(step.removed.size(), 12 * kMapMessageRecords);
  std::string out;
  out.reserve(kHeaderBytes + sizeof(SplatRecord) * (last - first) + 4 * (last_gone - first_gone) +
              step.to->stride() * (last - first));
  const int flags = (i == 0 && step.reset ? kResetFlag : 0) | (i + 1 == count ? kLastFlag : 0);
  append(out, kMapKind);
  append(out, static_cast<std::uint8_t>(flags));
  append(out, static_cast<std::uint8_t>(step.to->degree));
  append(out, std::uint8_t{0});
  append(out, std::uint32_t{0});
  append(out, step.to->version);
  append(out, static_cast<std::uint32_t>(last - first));
  append(out, static_cast<std::uint32_t>(last_gone - first_gone));
  for (std::size_t c = first; c < last; ++c) append(out, step.to->records[step.changed[c]]);
  for (std::size_t c = first_gone; c < last_gone; ++c) append(out, step.removed[c]);
  const std::size_t stride = step.to->stride();
  for (std::size_t c = first; c < last; ++c) {
    out.append(step.to->harmonics, step.changed[c] * stride, stride);
  }
  return out;
}

}  // namespace sgs::viewer
