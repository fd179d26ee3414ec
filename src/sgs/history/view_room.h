// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sgs/history/view_store.h"

namespace sgs::history {

/// What views and their store share: where pictures lie. It lives as long as any of them.
class ViewRoom {
 public:
  ViewRoom(std::size_t budget_bytes, ViewStore::Options options)
      : budget_bytes_(budget_bytes), options_(std::move(options)) {}

  StoredViewPtr keep(const RgbdFrame& frame, const CalibrationPtr& calibration,
                     const std::shared_ptr<ViewRoom>& self, bool changed = false);
  void forget(const StoredView& view) noexcept;
  PicturesPtr pictures(const StoredView& view);
  void note_beside(std::size_t bytes);
  std::size_t excess_bytes() const;
  std::size_t reads() const;
  std::size_t bytes_in_memory() const;

  bool has_work() const;
  /// What the writing thread does until stop(). Waked where there may be work.
  void write_on();
  void wake() { changed_.notify_all(); }
  void stop();
  void settle();
  /// Nothing goes to the disk from now on.
  void give_up(const std::string& why);

 private:
  /// Index of the frame, and whether it is another than was delivered.
  using Key = std::pair<std::int64_t, bool>;
  static Key key_of(const StoredView& view) { return {view.index_, view.changed_}; }
  std::shared_ptr<StoredView> find(const Key& key) const;
  bool wants_to_write() const;
  std::shared_ptr<StoredView> oldest() const;
  void park(StoredView& view);
  Result<std::int64_t> write(const Pictures& pictures);
  PicturesPtr read(const StoredView& view, std::int64_t at, std::size_t print);
  PicturesPtr lose(const StoredView& view, const std::string& why);

  const std::size_t budget_bytes_;
  const ViewStore::Options options_;
  std::optional<SpillFile> file_;  // written by one thread, which makes it before a view is there
  bool told_slow_ = false;         // likewise

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<Key, std::weak_ptr<StoredView>> views_;
  std::set<Key> in_memory_;  // of these
  std::size_t in_memory_bytes_ = 0, beside_bytes_ = 0, parked_ = 0, reads_ = 0;
  std::vector<std::pair<std::int64_t, std::size_t>> released_;  // of the file: where, how much
  bool failed_ = false;                                         // the disk takes nothing
  bool stopped_ = false;
};

}  // namespace sgs::history
