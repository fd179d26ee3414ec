// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sgs/map/gaussian.h"

namespace sgs::viewer {

/// One Gaussian as it goes over the wire (little-endian, as it lies in memory).
struct SplatRecord {
  std::uint32_t id = 0;
  float position[3] = {};  ///< world, metres
  float scale[3] = {};     ///< standard deviations, metres
  float rotation[4] = {};  ///< unit quaternion w x y z
  std::uint8_t rgba[4] = {};
};
static_assert(sizeof(SplatRecord) == 48);

/// The encoded form of a Gaussian.
SplatRecord encode_splat(const map::Gaussian& gaussian, std::uint32_t id);

/// What some clients have of the map: records by increasing id. Immutable and shared.
struct ClientMap {
  std::uint64_t version = 0;
  std::vector<SplatRecord> records;
  int degree = 0;         ///< of the harmonics
  std::string harmonics;  ///< io::harmonic_records() of the records
  /// Bytes of `harmonics` per record.
  std::size_t stride() const { return records.empty() ? 0 : harmonics.size() / records.size(); }
};
using ClientMapPtr = std::shared_ptr<const ClientMap>;

/// The way from one client map to the next.
struct MapStep {
  ClientMapPtr to;
  bool reset = false;                  ///< start from nothing
  std::vector<std::uint32_t> changed;  ///< indices into `to->records`: added or changed
  std::vector<std::uint32_t> removed;  ///< ids
};

/// What a client that has `from` (null: nothing) needs to see `snapshot`. Changes that nobody sees
/// (a small part of the splat's own size, 2/255 of colour) are left for later: then `to` holds the
/// record as the client has it, so that small steps add up until they are worth sending. `exact`
/// sends every difference. A snapshot whose ids do not rise leads to a reset with new ids, one with
/// harmonics of another degree to a reset.
/// Linear in both sizes.
MapStep map_step(const ClientMapPtr& from, const map::Snapshot& snapshot, bool exact);

/// Messages of bounded size for a step: number `i` of map_message_count(), see docs/viewer.md.
std::size_t map_message_count(const MapStep& step);
std::string map_message(const MapStep& step, std::size_t i);

/// Splats per message.
inline constexpr std::size_t kMapMessageRecords = 8192;

}  // namespace sgs::viewer
