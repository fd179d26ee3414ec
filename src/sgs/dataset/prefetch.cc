// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/prefetch.h"

#include <exception>
#include <thread>
#include <utility>

#include "sgs/core/bounded_queue.h"

namespace sgs::dataset {

struct PrefetchingSource::State {
  struct Item {
    FrameRead read = FrameRead::kEnd;
    RgbdFrame frame;
    Error error;
    std::exception_ptr exception;
  };

  State(std::unique_ptr<FrameSource> wrapped, std::size_t depth)
      : source(std::move(wrapped)),
        name(source->name()),
        camera(source->camera()),
        size(source->size()),
        queue(depth, FullPolicy::kBlock),
        worker([this] { produce(); }) {}

  ~State() {
    stop();
    worker.join();
  }

  // A next() that waits for a camera must not keep the thread.
  void stop() {
    queue.close();
    source->stop();
  }

  void produce() {
    Item item;
    do {
      item = Item{};
      try {
        item.read = source->next(item.frame, item.error);
      } catch (...) {
        item.read = FrameRead::kEnd;
        item.exception = std::current_exception();
      }
      const bool last = item.read == FrameRead::kEnd;
      if (!queue.push(std::move(item)) || last) break;
    } while (true);
    queue.close();
  }

  // Only `worker` uses the source's next(); the rest of it is constant and kept here.
  std::unique_ptr<FrameSource> source;
  std::string name;
  PinholeCamera camera;
  std::optional<std::int64_t> size;
  BoundedQueue<Item> queue;
  std::thread worker;  // last: starts when everything it uses is there
};

PrefetchingSource::PrefetchingSource(std::unique_ptr<FrameSource> source, std::size_t depth) {
  SGS_CHECK(source != nullptr, "a source to read ahead from is needed");
  SGS_CHECK(depth >= 1, "at least one frame must fit");
  state_ = std::make_unique<State>(std::move(source), depth);
}

PrefetchingSource::~PrefetchingSource() = default;

std::string PrefetchingSource::name() const { return state_->name; }
PinholeCamera PrefetchingSource::camera() const { return state_->camera; }
std::optional<std::int64_t> PrefetchingSource::size() const { return state_->size; }
const Trajectory& PrefetchingSource::ground_truth() const { return state_->source->ground_truth(); }

FrameRead PrefetchingSource::next(RgbdFrame& frame, Error& error) {
  auto item = state_->queue.pop();
  if (!item) return FrameRead::kEnd;
  if (item->exception) std::rethrow_exception(item->exception);
  if (item->read != FrameRead::kEnd) frame = std::move(item->frame);
  if (item->read == FrameRead::kBadFrame || item->read == FrameRead::kEvent) {
    error = std::move(item->error);
  }
  return item->read;
}

bool PrefetchingSource::live() const { return state_->source->live(); }
void PrefetchingSource::stop() { state_->stop(); }

}  // namespace sgs::dataset
