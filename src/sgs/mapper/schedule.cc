// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/schedule.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "sgs/core/error.h"

namespace sgs::mapper {

bool Schedule::consistent() const {
  const bool in_order =
      std::adjacent_find(active_.begin(), active_.end(), std::greater_equal<>()) == active_.end();
  if (!in_order || active_.empty() != (count_ == 0)) return false;
  if (count_ > 0 && active_.back() >= count_) return false;
  const auto known = [this](std::size_t index) {
    return std::binary_search(active_.begin(), active_.end(), index);
  };
  return balanced_.size() == count_ && balanced_.consistent() &&
         std::all_of(fresh_.begin(), fresh_.end(), known) &&
         std::all_of(round_.begin(), round_.end(), known);
}

void Schedule::add_keyframe(std::size_t index) {
  count_ = index + 1;
  active_.push_back(index);
  fresh_.push_back(index);
  balanced_.add(0, random_);
}

void Schedule::cull(std::size_t index) {
  SGS_CHECK(active_.size() > 1, "a keyframe must be left");
  std::erase(active_, index);
  std::erase(fresh_, index);
  std::erase(round_, index);
}

std::size_t Schedule::next() {
  SGS_CHECK(count_ > 0, "the schedule needs a keyframe");
  std::size_t index = 0;
  if (!fresh_.empty()) {
    index = fresh_.front();
    fresh_.erase(fresh_.begin());
  } else {
    switch (order_) {
      case VisitOrder::kBalanced:
        index = balanced_.next(active_, random_);
        break;
      case VisitOrder::kRounds:
        index = next_in_round();
        break;
      case VisitOrder::kRandom:
        index = active_[random_.below(active_.size())];
        break;
    }
  }
  count_visit(index);
  return index;
}

std::size_t Schedule::next_in_round() {
  if (round_.empty()) {
    round_ = active_;
    for (std::size_t i = round_.size() - 1; i > 0; --i) {
      std::swap(round_[i], round_[random_.below(i + 1)]);
    }
  }
  const std::size_t index = round_.back();
  round_.pop_back();
  return index;
}

void Schedule::count_visit(std::size_t index) {
  constexpr double kSoftening = 4;
  balanced_.set_weight(index, std::pow(balanced_.count_visit(index) + kSoftening, -visit_bias_));
}

}  // namespace sgs::mapper
