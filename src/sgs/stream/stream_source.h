// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include "sgs/dataset/frame_source.h"
#include "sgs/dataset/imu.h"
#include "sgs/stream/address.h"
#include "sgs/stream/protocol.h"

namespace sgs::stream {

/// How long a stream may keep its reader waiting.
struct Patience {
  double first_s = 30;    ///< without a first sender; 0 = for ever
  double stall_s = 2;     ///< without a frame: then that is said
  double wait_s = 30;     ///< with a sender that went away or is silent: then it is over; 0 = never
  double greeting_s = 5;  ///< from a connection to its greeting
};

/// Sees what a stream sends, as it was sent, just before it is used.
class StreamWatcher {
 public:
  virtual ~StreamWatcher() = default;
  virtual void on_packet(const Packet& packet) = 0;
  virtual void on_samples(std::span<const InertialSample> samples) = 0;
};

/// Frames that somebody sends (docs/stream.md). One sender at a time; over TCP this side listens,
/// on addresses of this machine only. What goes wrong is an event with a reason: no frame for a
/// while and frames again, a sender that goes away and one that is there again, a sender that is
/// refused (no greeting, another camera, a stream that is none). A frame whose time is not after
/// that of the frame before is a bad one. When nobody sends for `wait_s`, or a pipe ends without
/// the end mark, next() throws SourceFailure.
///
/// A camera is a sender that this side starts, and starts again when it has ended. Times of its own
/// clock are moved to follow those before where the clock stands elsewhere then.
///
/// Reading is the sender's brake: nothing is taken from the connection before it is asked for, but
/// one frame. next() belongs to one thread; stop() may be called from any and ends its waiting.
class StreamSource : public dataset::FrameSource {
 public:
  ~StreamSource() override;
  /// What the first sender said; the camera stays the same with every later one.
  virtual const Hello& hello() const = 0;
  /// What an inertial unit has measured so far: accelerations, mean values of 0.04 s each. Empty
  /// where the sender has none. Thread-safe.
  virtual dataset::ImuRecording imu() const = 0;
  /// From the next frame on; `watcher` lives longer. Called by next().
  virtual void watch(StreamWatcher& watcher) = 0;
};

/// Opens the stream and waits for the greeting; `announce` is told what is waited for. Errors: an
/// address that cannot be had, a camera's reason to give no frames, nobody there within `first_s`,
/// a pipe that holds something else, and kInterrupted when a stop is requested.
Result<std::unique_ptr<StreamSource>> open_stream(
    const Address& address, const Patience& patience,
    const std::function<void(const std::string&)>& announce, const std::stop_token& stop = {});

}  // namespace sgs::stream
