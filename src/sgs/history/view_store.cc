// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/history/view_store.h"

#include <system_error>
#include <utility>

#include "sgs/camera/movers.h"
#include "sgs/history/view_room.h"

namespace sgs::history {

ViewStore::ViewStore(std::size_t budget_bytes, Options options)
    : room_(std::make_shared<ViewRoom>(budget_bytes, std::move(options))) {}

ViewStore::ViewStore(const HistoryConfig& config, double farthest_m)
    : ViewStore(static_cast<std::size_t>(config.memory_mb) << 20, {.farthest_m = farthest_m}) {}

ViewStore::~ViewStore() {
  room_->stop();
  if (writer_.joinable()) writer_.join();
}

StoredViewPtr ViewStore::keep(const RgbdFrame& frame, const CalibrationPtr& calibration) {
  auto view = frame.delivered ? keep_delivered(frame) : room_->keep(frame, calibration, room_);
  wake();
  return view;
}

// What moves was not known yet when it came.
StoredViewPtr ViewStore::keep_delivered(const RgbdFrame& frame) {
  if (!frame.still) return room_->keep(*frame.delivered, nullptr, room_);
  RgbdFrame still = *frame.delivered;
  leave_out_movers(still, frame.still);
  return room_->keep(still, nullptr, room_);
}

StoredViewPtr ViewStore::keep_changed(const RgbdFrame& frame, const CalibrationPtr& calibration) {
  auto view = room_->keep(frame, calibration, room_, true);
  wake();
  return view;
}

void ViewStore::note_beside(std::size_t bytes) {
  room_->note_beside(bytes);
  wake();
}

void ViewStore::wake() {
  if (!room_->has_work()) return;
  const std::lock_guard lock(starting_);
  if (writer_.joinable()) return room_->wake();
  try {
    writer_ = std::thread([room = room_] { room->write_on(); });
  } catch (const std::system_error& failure) {
    room_->give_up(failure.what());
  }
}

std::size_t ViewStore::excess_bytes() const { return room_->excess_bytes(); }
void ViewStore::settle() { room_->settle(); }
std::size_t ViewStore::reads() const { return room_->reads(); }
std::size_t ViewStore::bytes_in_memory() const { return room_->bytes_in_memory(); }

}  // namespace sgs::history
