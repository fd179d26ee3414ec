// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/status_teller.h"

#include <algorithm>
#include <cmath>

#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"

namespace sgs::run {

StatusTeller::StatusTeller(RunObserver& observer, const PinholeCamera& camera, bool at_camera_rate,
                           bool watches, const FrameRecorder* recorder)
    : observer_(observer), recorder_(recorder), watch_(camera), watches_(watches) {
  status_.at_camera_rate = at_camera_rate;
}

void StatusTeller::frame(const dataset::FeedItem& item, const slam::FrameRecord& record,
                         const FeedCounts& counts, const std::string& trouble) {
  constexpr double kFollow = 0.1;  // over the last frames
  if (!record.bad) {
    status_.track_ms = std::isnan(status_.track_ms)
                           ? record.track_ms
                           : status_.track_ms + kFollow * (record.track_ms - status_.track_ms);
  }
  const auto before = status_.warnings.size();
  if (item.frame && watches_) watch(*item.frame, record);
  tell(counts, trouble, before != status_.warnings.size() || trouble != status_.trouble);
}

void StatusTeller::moment(const FeedCounts& counts, const std::string& trouble) {
  tell(counts, trouble, trouble != status_.trouble);
}

void StatusTeller::gap() {
  watch_.forget_motion();
  samples_.clear();
}

void StatusTeller::watch(const RgbdFrame& frame, const slam::FrameRecord& record) {
  for (const auto& change :
       watch_.add(frame, record.status, record.T_online_camera, record.diagnostics.movers)) {
    if (change.on) {
      log().warn("frame {} ({:.3f} s): {}", record.index, record.timestamp_s, change.text);
      status_.warnings.push_back({change.warning, change.text});
    } else {
      std::erase_if(status_.warnings, [&](const auto& w) { return w.what == change.warning; });
    }
  }
}

// Of frames that come, over the last seconds.
double StatusTeller::rate(const FeedCounts& counts, double now_s) {
  constexpr double kWindow_s = 3;
  samples_.push_back({now_s, counts.delivered});
  while (samples_.size() > 2 && now_s - samples_.front().time_s > kWindow_s) samples_.pop_front();
  const double span_s = now_s - samples_.front().time_s;
  if (!(span_s > 0)) return LiveStatus::kNone;
  return static_cast<double>(counts.delivered - samples_.front().delivered) / span_s;
}

void StatusTeller::tell(const FeedCounts& counts, const std::string& trouble, bool now) {
  constexpr double kEvery_s = 0.2;
  const double now_s = wall_time_s();
  if (!now && now_s - told_s_ < kEvery_s) return;
  told_s_ = now_s;
  status_.dropped = static_cast<std::int64_t>(counts.dropped);
  status_.left_out = static_cast<std::int64_t>(counts.left_out);
  status_.camera_fps = rate(counts, now_s);
  status_.trouble = trouble;
  if (recorder_ != nullptr) status_.recording = recorder_->status();
  observer_.on_status(status_);
}

}  // namespace sgs::run
