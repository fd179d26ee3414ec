// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Recordings of messages. The first byte chooses the container: ROS 1 bag, MCAP, SQLite or
// Matroska.
#include "sgs/bag/bag.h"

#include <array>
#include <numeric>

#include "harness.h"
#include "sgs/bag/messages.h"
#include "sgs/bag/pictures.h"
#include "sgs/dataset/open.h"

namespace {

using namespace sgs;

/// Every reader of messages on every message, whatever its type: types can lie.
void read_as_everything(const bag::Message& message, bag::Encoding encoding) {
  constexpr std::uint32_t kLargestSide = 512;  // larger pictures only cost time here
  (void)bag::read_header(message, encoding);
  (void)bag::read_camera_info(message, encoding);
  (void)bag::read_transforms(message, encoding);
  (void)bag::read_imu(message, encoding);
  (void)bag::read_pose(message, encoding);
  (void)bag::read_odometry(message, encoding);
  (void)bag::read_plain_transform(message, encoding);
  (void)bag::read_extrinsics(message, encoding, bag::RotationOrder::kColumns);
  (void)bag::read_string(message, encoding);
  (void)bag::read_float(message, encoding);
  if (const auto image = bag::read_image(message, encoding)) {
    const bool small = image->width <= kLargestSide && image->height <= kLargestSide;
    if (small) {
      if (const auto color = bag::decode_color(*image)) {
        fuzz::require(color->width() == static_cast<int>(image->width), "colour has its size");
      }
      (void)bag::byte_order_contradicts(*image);
      if (const auto depth = bag::decode_depth(*image, {})) {
        fuzz::require(depth->height() == static_cast<int>(image->height), "depth has its size");
      }
    }
  }
  if (const auto image = bag::read_compressed_image(message, encoding)) {
    (void)bag::decode_color(*image);
    (void)bag::decode_depth(*image, {});
  }
}

void read_messages(const std::filesystem::path& path) {
  constexpr int kMostMessages = 200;
  const auto bag = bag::open_bag(path);
  if (!bag) return;
  std::vector<std::size_t> all((*bag)->channels().size());
  std::iota(all.begin(), all.end(), 0u);
  const auto cursor = (*bag)->read(all);
  for (int i = 0; i < kMostMessages; ++i) {
    const auto message = cursor->next();
    if (!message) continue;
    if (!*message) return;
    fuzz::require((*message)->channel < all.size(), "messages are of known channels");
    read_as_everything(**message, (*bag)->channels()[(*message)->channel].encoding);
  }
}

void read_frames(const std::filesystem::path& path) {
  dataset::OpenOptions options;
  options.prefetch = 0;
  const auto sequence = dataset::open_sequence(path, options);
  if (!sequence) return;
  RgbdFrame frame;
  Error error;
  for (int i = 0; i < 10; ++i) {
    const auto read = sequence->frames->next(frame, error);
    if (read == dataset::FrameRead::kEnd) break;
    if (read != dataset::FrameRead::kOk) continue;
    fuzz::require(frame.color.width() == frame.camera.width, "frames have their camera's size");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 4> kNames = {"x.bag", "x.mcap", "x.db3", "x.mkv"};
  const fuzz::Choice choice(data, size);
  const auto path = fuzz::scratch_file(kNames[choice.number % kNames.size()]);
  fuzz::write_plainly(path, choice.rest);
  read_messages(path);
  read_frames(path);
  return 0;
}
