// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What a client of `sgs run live:...`, or a program for a camera, may send. The first byte says in
// which pieces it comes.
#include "harness.h"
#include "sgs/stream/frame_codec.h"
#include "sgs/stream/inertial_store.h"
#include "sgs/stream/protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sgs;
  using Part = stream::StreamParser::Part;
  constexpr std::size_t kMostPixels = 1 << 20;  // larger cameras only cost time here
  const fuzz::Choice choice(data, size);
  const std::size_t piece = 1 + choice.number;
  stream::StreamParser parser;
  std::optional<stream::FrameDecoder> decoder;
  stream::InertialStore inertial;
  for (std::size_t at = 0; at < choice.rest.size(); at += piece) {
    parser.push(choice.rest.substr(at, piece));
    while (true) {
      const auto part = parser.next();
      if (!part) {
        fuzz::require(!parser.next(), "an error stays");
        return 0;
      }
      if (*part == Part::kNone) break;
      if (*part == Part::kEnd) return 0;
      if (*part == Part::kImu) {
        inertial.add(parser.imu(), 0, parser.hello());
        continue;
      }
      if (*part == Part::kHello) {
        const auto& hello = parser.hello();
        const PinholeCamera& c = hello.camera_of_depth().camera;
        fuzz::require(hello.color_camera.camera.valid() && c.valid(), "cameras are usable");
        const auto pixels = [](const PinholeCamera& camera) {
          return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
        };
        if (pixels(c) > kMostPixels || pixels(hello.color_camera.camera) > kMostPixels) return 0;
        decoder.emplace(hello);
        continue;
      }
      RgbdFrame frame;
      if (!decoder->decode(parser.packet(), frame)) continue;
      fuzz::require(frame.depth.width() == frame.camera.width, "frames have their camera's size");
      fuzz::require(!frame.still || frame.still->size() == frame.depth.size(), "masks, too");
      for (std::size_t i = 0; i < frame.depth.size(); ++i) {
        fuzz::require(frame.depth.data()[i] >= 0, "depth is never negative");
      }
    }
  }
  return 0;
}
