// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "preloaded_source.h"

#include <deque>
#include <utility>

#include "interrupt.h"

namespace sgs::app {
namespace {

class PreloadedSource final : public dataset::FrameSource {
 public:
  explicit PreloadedSource(std::unique_ptr<dataset::FrameSource> source)
      : source_(std::move(source)) {
    Item item;
    while (!interrupted() &&
           (item.status = source_->next(item.frame, item.error)) != dataset::FrameRead::kEnd) {
      items_.push_back(std::exchange(item, {}));
    }
  }

  std::string name() const override { return source_->name(); }
  PinholeCamera camera() const override { return source_->camera(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  dataset::FrameRead next(RgbdFrame& frame, Error& error) override {
    if (items_.empty()) return dataset::FrameRead::kEnd;
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
    dataset::FrameRead status = dataset::FrameRead::kEnd;
  };

  std::unique_ptr<dataset::FrameSource> source_;
  std::deque<Item> items_;
};

}  // namespace

std::unique_ptr<dataset::FrameSource> preload(std::unique_ptr<dataset::FrameSource> source) {
  return std::make_unique<PreloadedSource>(std::move(source));
}

}  // namespace sgs::app
