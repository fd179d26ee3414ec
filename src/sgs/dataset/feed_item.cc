// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/feed_item.h"

namespace sgs::dataset {

std::optional<FeedItem> read_item(FrameSource& source) {
  auto frame = std::make_shared<RgbdFrame>();
  Error error;
  const FrameRead status = source.next(*frame, error);
  if (status == FrameRead::kEnd) return std::nullopt;
  FeedItem item{nullptr, frame->index, frame->timestamp_s, ""};
  if (status == FrameRead::kOk) {
    item.frame = std::move(frame);
  } else {
    item.bad_reason = error.text();
    item.event = status == FrameRead::kEvent;
  }
  return item;
}

}  // namespace sgs::dataset
