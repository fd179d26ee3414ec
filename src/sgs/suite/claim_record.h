// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "sgs/core/enum_names.h"

namespace sgs::suite {

enum class ClaimState {
  kWorking,   ///< somebody is at it, or was killed
  kReleased,  ///< given back undone
  kDone,
  kFailed,
};
constexpr auto enum_names(ClaimState) {
  using enum ClaimState;
  return std::to_array<EnumName<ClaimState>>(
      {{kWorking, "working"}, {kReleased, "released"}, {kDone, "done"}, {kFailed, "failed"}});
}

/// A process, so that others on the same machine can tell whether it still lives: the machine's
/// boot, the name space of process numbers, the number, and when it started.
std::string process_identity(int pid);
/// Whether that process has certainly ended. False for one of another machine or boot.
bool has_ended(std::string_view identity);

/// What a file of a claim says.
struct ClaimRecord {
  ClaimState state = ClaimState::kWorking;
  std::int64_t beat = 0;  ///< counts the signs of life
  std::string worker;     ///< machine and process, for people
  std::string identity;   ///< process_identity()

  friend bool operator==(const ClaimRecord&, const ClaimRecord&) = default;
};

/// Every record is as long as this, bytes: it is written in place and in one piece.
inline constexpr std::size_t kClaimRecordBytes = 512;

std::string claim_text(const ClaimRecord& record);
/// Reads claim_text(); what is missing or damaged has its default: an empty file is a claim of
/// somebody who has not got round to saying more.
ClaimRecord parse_claim(std::string_view text);

}  // namespace sgs::suite
