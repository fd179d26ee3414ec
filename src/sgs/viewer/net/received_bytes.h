// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "sgs/viewer/net/core.h"

namespace sgs::viewer::net {

/// Counts what comes in on a connection, below all protocols: a peer can hide messages from the
/// WebSocket layer (fragments without end and without content are swallowed there), but not bytes.
/// A Beast RatePolicy that never limits.
class ReceivedBytes {
 public:
  std::uint64_t count() const { return count_; }

 private:
  friend class beast::rate_policy_access;
  static constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

  std::size_t available_read_bytes() const { return kUnlimited; }
  std::size_t available_write_bytes() const { return kUnlimited; }
  void transfer_read_bytes(std::size_t bytes) { count_ += bytes; }
  void transfer_write_bytes(std::size_t) {}
  void on_timer() {}

  std::uint64_t count_ = 0;
};

}  // namespace sgs::viewer::net
