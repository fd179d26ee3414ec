// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/preloaded_source.h"

#include <deque>
#include <utility>

namespace sgs::dataset {
namespace {

class PreloadedSource final : public FrameSource {
 public:
  PreloadedSource(std::unique_ptr<FrameSource> source, const std::stop_token& stop)
      : source_(std::move(source)) {
    Item item;
    while (!stop.stop_requested() &&
           (item.status = source_->next(item.frame, item.error)) != FrameRead::kEnd) {
      items_.push_back(std::exchange(item, {}));
    }
  }

  std::string name() const override { return source_->name(); }
  PinholeCamera camera() const override { return source_->camera(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  FrameRead next(RgbdFrame& frame, Error& error) override {
    if (items_.empty()) return FrameRead::kEnd;
    Item item = std::move(items_.front());
    items_.pop_front();
    frame = std::move(item.frame);
    error = std::move(item.error);
    return item.status;
  }

 private:
  struct Item {
    RgbdFrame frame;
    Error error;
    FrameRead status = FrameRead::kEnd;
  };

  std::unique_ptr<FrameSource> source_;
  std::deque<Item> items_;
};

}  // namespace

std::unique_ptr<FrameSource> preload(std::unique_ptr<FrameSource> source,
                                     const std::stop_token& stop) {
  return std::make_unique<PreloadedSource>(std::move(source), stop);
}

}  // namespace sgs::dataset
