// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/history/view_room.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <string_view>
#include <system_error>
#include <thread>

#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"

namespace sgs::history {
namespace {

constexpr double kSlow_s = 1;  // for one view of a megabyte or two

std::string_view bytes_of(const auto& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(*image.data())};
}

std::size_t print_of(const Pictures& pictures) {
  const std::hash<std::string_view> hash;
  return hash(bytes_of(pictures.color)) + 31 * hash(bytes_of(pictures.depth));
}

}  // namespace

std::shared_ptr<StoredView> ViewRoom::find(const Key& key) const {
  const auto found = views_.find(key);
  return found != views_.end() ? found->second.lock() : nullptr;
}

StoredViewPtr ViewRoom::keep(const RgbdFrame& frame, const CalibrationPtr& calibration,
                             const std::shared_ptr<ViewRoom>& self, bool changed) {
  const Key key(frame.index, changed);
  {
    const std::lock_guard lock(mutex_);
    if (auto view = find(key)) return view;
  }
  const auto made = std::make_shared<StoredView>(frame, options_.farthest_m, calibration);
  const std::lock_guard lock(mutex_);
  if (auto view = find(key)) return view;  // somebody was faster
  views_[key] = made;
  in_memory_.insert(key);
  in_memory_bytes_ += made->bytes();
  made->changed_ = changed;
  made->room_ = self;
  return made;
}

// Another view of that index may have come meanwhile.
void ViewRoom::forget(const StoredView& view) noexcept {
  const std::lock_guard lock(mutex_);
  const auto found = views_.find(key_of(view));
  if (found != views_.end() && found->second.expired()) {
    in_memory_.erase(found->first);
    views_.erase(found);
  }
  if (view.pictures_) in_memory_bytes_ -= view.bytes();
  if (view.at_ < 0) return;
  released_.emplace_back(view.at_, view.bytes());  // park() made room for it
  --parked_;
}

void ViewRoom::note_beside(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  beside_bytes_ = bytes;
}

std::size_t ViewRoom::excess_bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t stays = in_memory_bytes_;
  if (!failed_ && in_memory_.size() > options_.least_in_memory) {
    stays = stays / in_memory_.size() * options_.least_in_memory;
  }
  const std::size_t used = stays + beside_bytes_;
  return used > budget_bytes_ ? used - budget_bytes_ : 0;
}

bool ViewRoom::wants_to_write() const {
  return !failed_ && in_memory_.size() > options_.least_in_memory &&
         in_memory_bytes_ + beside_bytes_ > budget_bytes_;
}

bool ViewRoom::has_work() const {
  const std::lock_guard lock(mutex_);
  return wants_to_write();
}

std::shared_ptr<StoredView> ViewRoom::oldest() const {
  for (const Key& key : in_memory_) {
    if (auto view = find(key)) return view;
  }
  return nullptr;
}

void ViewRoom::write_on() {
  std::unique_lock lock(mutex_);
  while (!stopped_) {
    if (!wants_to_write()) {
      changed_.wait(lock);
      continue;
    }
    auto view = oldest();
    lock.unlock();
    try {
      if (view) park(*view);
    } catch (const std::exception& failure) {
      give_up(failure.what());
    }
    view.reset();  // where nobody else has it, it is forgotten: not under the lock
    lock.lock();
    changed_.notify_all();
  }
}

void ViewRoom::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
}

void ViewRoom::settle() {
  std::unique_lock lock(mutex_);
  changed_.notify_all();
  changed_.wait(lock, [this] { return !wants_to_write(); });
}

void ViewRoom::give_up(const std::string& why) {
  const std::lock_guard lock(mutex_);
  failed_ = true;
  log().warn("frames that are remembered stay in memory, beyond history.memory_mb: {}", why);
}

// Only the writing thread changes where pictures lie, so it may look at them without the lock, and
// nobody waits for the disk.
void ViewRoom::park(StoredView& view) {
  const std::size_t print = print_of(*view.pictures_);
  const double begin_s = wall_time_s();
  const auto at = write(*view.pictures_);
  if (!at) return give_up(at.error().text());
  const double took_s = wall_time_s() - begin_s;
  if (took_s > kSlow_s && !std::exchange(told_slow_, true)) {
    log().warn(
        "{} is slow: it took {:.0f} s for one frame that is remembered there; set TMPDIR to "
        "a folder on another disk",
        options_.folder.string(), took_s);
  }
  PicturesPtr gone;  // not under the lock
  const std::lock_guard lock(mutex_);
  released_.reserve(released_.size() + ++parked_);
  view.at_ = *at;
  view.print_ = print;
  view.lately_ = view.pictures_;
  in_memory_bytes_ -= view.bytes();
  in_memory_.erase(key_of(view));
  gone = std::move(view.pictures_);
}

Result<std::int64_t> ViewRoom::write(const Pictures& pictures) {
  if (!file_) {
    SGS_ASSIGN_OR_RETURN(file_, SpillFile::create(options_.folder));
  }
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [at, size] : released_) file_->release(at, size);
    released_.clear();
  }
  std::string bytes(bytes_of(pictures.color));
  bytes += bytes_of(pictures.depth);
  return file_->append(bytes.data(), bytes.size());
}

PicturesPtr ViewRoom::pictures(const StoredView& view) {
  std::int64_t at = 0;
  std::size_t print = 0;
  {
    const std::lock_guard lock(mutex_);
    if (view.pictures_ || view.gone_) return view.pictures_;
    if (auto held = view.lately_.lock()) return held;
    at = view.at_;
    print = view.print_;
    ++reads_;
  }
  return read(view, at, print);
}

PicturesPtr ViewRoom::read(const StoredView& view, std::int64_t at, std::size_t print) {
  auto out = std::make_shared<Pictures>();
  out->color = ColorImage(view.camera_.width, view.camera_.height);
  out->depth = Image<std::uint16_t>(view.camera_.width, view.camera_.height);
  const std::size_t color_bytes = bytes_of(out->color).size();
  try {
    file_->read(at, out->color.data(), color_bytes);
    file_->read(at + static_cast<std::int64_t>(color_bytes), out->depth.data(),
                bytes_of(out->depth).size());
  } catch (const std::system_error& failure) {
    return lose(view, failure.what());
  }
  if (print_of(*out) != print) return lose(view, "it is not what was written");
  const std::lock_guard lock(mutex_);
  view.lately_ = out;
  return out;
}

PicturesPtr ViewRoom::lose(const StoredView& view, const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(view.gone_, true)) {
    log().warn("what is remembered of frame {} is gone from {}, and the run goes on without: {}",
               view.index_, options_.folder.string(), why);
  }
  return nullptr;
}

std::size_t ViewRoom::reads() const {
  const std::lock_guard lock(mutex_);
  return reads_;
}

std::size_t ViewRoom::bytes_in_memory() const {
  const std::lock_guard lock(mutex_);
  return in_memory_bytes_;
}

}  // namespace sgs::history
