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
  const bool credits_finite = std::all_of(entries_.begin(), entries_.end(), [](const Entry& e) {
    return std::isfinite(e.credit) && e.visits >= 0;
  });
  return entries_.size() == count_ && credits_finite &&
         std::all_of(fresh_.begin(), fresh_.end(), known) &&
         std::all_of(round_.begin(), round_.end(), known);
}

void Schedule::add_keyframe(std::size_t index) {
  count_ = index + 1;
  active_.push_back(index);
  fresh_.push_back(index);
  const double jitter = random_.uniform();
  entries_.push_back({jitter, jitter, 0, 0});
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
        index = next_balanced();
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

std::size_t Schedule::next_balanced() {
  double sum = 0;
  for (const std::size_t i : active_) sum += entries_[i].weight;
  std::size_t best = active_.front();
  for (const std::size_t i : active_) {
    entries_[i].credit += entries_[i].weight / sum;
    if (entries_[i].credit > entries_[best].credit) best = i;
  }
  Entry& entry = entries_[best];
  const double jitter = random_.uniform();
  entry.credit += jitter - entry.jitter - 1;
  entry.jitter = jitter;
  return best;
}

void Schedule::count_visit(std::size_t index) {
  constexpr double kSoftening = 4;
  Entry& entry = entries_[index];
  entry.weight = std::pow(++entry.visits + kSoftening, -visit_bias_);
}

}  // namespace sgs::mapper
