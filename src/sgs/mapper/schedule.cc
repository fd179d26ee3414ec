// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/schedule.h"

#include <utility>

#include "sgs/core/error.h"

namespace sgs::mapper {

void Schedule::add_keyframe(std::size_t index) {
  count_ = index + 1;
  fresh_.push_back(index);
}

std::size_t Schedule::next() {
  SGS_CHECK(count_ > 0, "the schedule needs a keyframe");
  if (!fresh_.empty()) {
    const std::size_t index = fresh_.front();
    fresh_.erase(fresh_.begin());
    return index;
  }
  if (!rounds_) return random_.below(count_);
  if (round_.empty()) {
    for (std::size_t i = 0; i < count_; ++i) round_.push_back(i);
    for (std::size_t i = count_ - 1; i > 0; --i) std::swap(round_[i], round_[random_.below(i + 1)]);
  }
  const std::size_t index = round_.back();
  round_.pop_back();
  return index;
}

}  // namespace sgs::mapper
