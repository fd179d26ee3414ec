// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "sgs/core/error.h"
#include "sgs/stream/address.h"
#include "sgs/stream/protocol.h"

namespace sgs::stream {

/// The sending end of a stream. Over TCP the other end answers the greeting and the end; what it
/// refuses is an error with its reason. Errors leave the sender as good as closed. Calls wait as
/// long as the other end takes its time; a connection that breaks ends the wait, and so does,
/// after two seconds in which nothing moved, a stop that is requested. One thread.
class Sender {
 public:
  /// Connects, or opens the pipe, and greets. Nobody there is kNotFound: one may try again.
  static Result<std::unique_ptr<Sender>> open(const Address& address, const Hello& hello,
                                              const std::stop_token& stop = {});
  virtual ~Sender() = default;

  virtual Status send(const Packet& packet) = 0;
  /// Says that nothing more comes, and waits until the other end has taken in everything.
  virtual Status finish() = 0;
};

}  // namespace sgs::stream
