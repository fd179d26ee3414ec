// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "sgs/dataset/frame_source.h"

namespace sgs::dataset {

/// Decodes ahead: a thread of its own reads frames from another source into a bounded queue (it
/// waits when the queue is full, nothing is dropped). Order and bad frames are passed through
/// unchanged; an exception thrown by the source is rethrown by next(). The destructor stops and
/// joins the thread. One reader.
class PrefetchingSource : public FrameSource {
 public:
  /// `depth` >= 1 frames are held decoded at most, besides the one in the making.
  PrefetchingSource(std::unique_ptr<FrameSource> source, std::size_t depth);
  ~PrefetchingSource() override;

  std::string name() const override;
  PinholeCamera camera() const override;
  std::optional<std::int64_t> size() const override;
  const Trajectory& ground_truth() const override;
  FrameRead next(RgbdFrame& frame, Error& error) override;
  bool live() const override;

  /// Ends the decoding; frames already decoded can still be read, then comes kEnd. May be called
  /// from any thread.
  void stop() override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sgs::dataset
