// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_modes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sgs/dataset/bags/bag_order.h"
#include "sgs/dataset/sdk_calibration.h"

namespace sgs::dataset {
namespace {

/// Numbers as they were written: NaN, too, is the same each time.
template <class Numbers>
bool same_numbers(const Numbers& a, const Numbers& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

}  // namespace

bool same_camera_info(const bag::CameraInfoMessage& a, const bag::CameraInfoMessage& b) {
  return a.width == b.width && a.height == b.height && same_numbers(a.K, b.K) &&
         same_numbers(a.P, b.P) && same_numbers(a.D, b.D) &&
         a.distortion_model == b.distortion_model && a.binning_x == b.binning_x &&
         a.binning_y == b.binning_y && a.roi_x == b.roi_x && a.roi_y == b.roi_y &&
         a.roi_width == b.roi_width && a.roi_height == b.roi_height;
}

Result<UsualCameraInfo> usual_camera_info(const bag::Bag& bag, std::size_t channel) {
  // A second of one mode is believed; where modes change, the next seconds decide.
  constexpr int kOneMode = 30, kMost = 150;
  const bag::Channel& about = bag.channels()[channel];
  const auto cursor = bag.read({channel});
  std::vector<std::pair<bag::CameraInfoMessage, int>> modes;
  std::optional<Error> first_error;
  for (int i = 0; i < kMost && !(i >= kOneMode && modes.size() == 1); ++i) {
    auto message = cursor->next();
    if (message && !*message) break;
    auto info = message ? read_any_camera_info(**message, about)
                        : Result<bag::CameraInfoMessage>(tl::unexpected(message.error()));
    if (!info) {
      if (!first_error) first_error = info.error();
      continue;
    }
    const auto known = std::find_if(modes.begin(), modes.end(), [&](const auto& mode) {
      return same_camera_info(mode.first, *info);
    });
    if (known != modes.end()) {
      ++known->second;
    } else {
      modes.emplace_back(std::move(*info), 1);
    }
  }
  if (modes.empty()) {
    if (first_error) return tl::unexpected<Error>(std::move(*first_error));
    return fail(ErrorCode::kNotFound, "no message");
  }
  auto most = std::max_element(modes.begin(), modes.end(),
                               [](const auto& a, const auto& b) { return a.second < b.second; });
  return UsualCameraInfo{std::move(most->first), modes.size() > 1};
}

CameraInfoTrack::CameraInfoTrack(const bag::Bag& bag, std::size_t channel)
    : about_(bag.channels()[channel]), cursor_(bag.read({channel})) {}

/// As far ahead as the pictures are read: the same parts of a file are unpacked once for both.
void CameraInfoTrack::read_ahead() {
  while (!ended_ && ahead_.size() < MessageOrder::kAhead) {
    auto message = cursor_->next();
    if (message && !*message) {
      ended_ = true;
    } else if (message) {
      auto info = read_any_camera_info(**message, about_);
      if (info) ahead_.push_back({(*message)->record_time_ns, std::move(*info)});
    }
  }
}

bool CameraInfoTrack::next_is_due(std::int64_t record_time_ns) const {
  if (ahead_.empty()) return false;
  if (!current_) return true;
  // What was recorded after the clock was set back is for pictures from after that, too.
  const bool set_back = ahead_.front().record_time_ns < current_->record_time_ns;
  return set_back ? record_time_ns < current_->record_time_ns
                  : ahead_.front().record_time_ns <= record_time_ns;
}

const bag::CameraInfoMessage* CameraInfoTrack::at(std::int64_t stamp_ns,
                                                  std::int64_t record_time_ns) {
  read_ahead();
  while (next_is_due(record_time_ns)) {
    current_ = std::move(ahead_.front());
    ahead_.pop_front();
    read_ahead();
  }
  if (!current_) return nullptr;
  if (current_->info.header.stamp_ns == stamp_ns) return &current_->info;
  const auto exact = std::find_if(ahead_.begin(), ahead_.end(), [&](const Recorded& next) {
    return next.info.header.stamp_ns == stamp_ns;
  });
  return exact == ahead_.end() ? &current_->info : &exact->info;
}

}  // namespace sgs::dataset
