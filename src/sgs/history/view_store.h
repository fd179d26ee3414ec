// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include "sgs/core/spill_file.h"
#include "sgs/history/history_config.h"
#include "sgs/history/stored_view.h"

namespace sgs::history {

/// Keeps the frames that are remembered, each once for all who remember it, within a budget of
/// memory: beyond it the pictures of the oldest go to a nameless file on the disk. What anybody
/// computes does not depend on where they lie. Thread-safe; views may outlive the store.
class ViewStore {
 public:
  struct Options {
    double farthest_m = 0;             ///< that depth is kept of; 0: 13 m
    std::size_t least_in_memory = 16;  ///< views, the newest, whatever the budget
    std::filesystem::path folder = SpillFile::default_folder();
  };
  ViewStore(std::size_t budget_bytes, Options options);
  explicit ViewStore(const HistoryConfig& config, double farthest_m = 0);
  ~ViewStore();

  /// Remembers a frame as it was delivered, without the depth of what moves (RgbdFrame::still): the
  /// view that there is of its index already, where somebody has one. Never waits for the disk: a
  /// thread writes what is beyond the budget. `calibration`: what has corrected the depth of a
  /// frame that is as it was delivered.
  StoredViewPtr keep(const RgbdFrame& frame, const CalibrationPtr& calibration = nullptr);
  /// The same for other pictures than the frame was delivered with, which stand beside these.
  StoredViewPtr keep_changed(const RgbdFrame& frame, const CalibrationPtr& calibration);

  /// What else counts against the budget.
  void note_beside(std::size_t bytes);
  /// By how much the budget is exceeded when all is written that may be: by what is beside the
  /// views, by the newest ones, or because the disk takes nothing, which is said once; then more
  /// memory is used.
  std::size_t excess_bytes() const;
  /// Waits until there is nothing to be written.
  void settle();

  /// How often a view was read from the disk so far.
  std::size_t reads() const;
  /// What pictures take in memory now.
  std::size_t bytes_in_memory() const;

 private:
  StoredViewPtr keep_delivered(const RgbdFrame& frame);
  void wake();

  std::shared_ptr<ViewRoom> room_;
  std::mutex starting_;
  std::thread writer_;  // begins when there is something to write
};

}  // namespace sgs::history
