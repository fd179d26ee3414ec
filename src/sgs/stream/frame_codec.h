// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/pair_rectifier.h"
#include "sgs/core/error.h"
#include "sgs/stream/protocol.h"

namespace sgs::stream {

/// Makes frames of what a stream sends: decodes, removes the lens distortion, and brings depth that
/// is not registered into the colour camera. Frames of a camera without distortion whose depth is
/// registered come out as they were sent, bit for bit.
class FrameDecoder {
 public:
  explicit FrameDecoder(const Hello& hello);

  const PinholeCamera& camera() const { return hello_.color_camera.camera; }
  /// Sets everything in `frame` but its index; RgbdFrame::still as the mask says. Images of another
  /// size than the greeting's, damaged ones, masks by which all moves and times that are not finite
  /// are errors.
  Status decode(Packet packet, RgbdFrame& frame);

 private:
  Hello hello_;
  PairRectifier rectifier_;
};

/// The images of a frame as the greeting promises them: rgb8 and f32 lose nothing; u16 rounds depth
/// to a raw unit and leaves out what does not fit below 65535. PNG is for other senders.
Result<Packet> encode_frame(const RgbdFrame& frame, const Hello& hello);

}  // namespace sgs::stream
