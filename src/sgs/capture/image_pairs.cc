// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/capture/image_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sgs::capture {

void ImagePairs::add(CameraImage image) {
  constexpr std::size_t kMostWaiting = 8;
  auto& queue = image.kind == CameraImage::Kind::kColor ? color_ : depth_;
  // In order of time; one that is not later than the last comes twice, or from a broken clock.
  if (!queue.empty() && image.stamp_s <= queue.back().stamp_s) return;
  queue.push_back(std::move(image));
  if (queue.size() <= kMostWaiting) return;
  if (&queue == &depth_) ++alone_;
  queue.pop_front();
}

std::optional<ImagePair> ImagePairs::next() {
  while (!depth_.empty() && !color_.empty()) {
    const double time_s = depth_.front().stamp_s;
    const auto apart = [&](const CameraImage& image) { return std::abs(image.stamp_s - time_s); };
    const auto nearest = std::ranges::min_element(color_, {}, apart);
    const bool final = color_.back().stamp_s >= time_s || apart(*nearest) < period_s_ / 2;
    if (!final) return std::nullopt;
    if (apart(*nearest) > most_s_) {
      ++alone_;
      depth_.pop_front();
      continue;
    }
    ImagePair pair{std::move(*nearest), std::move(depth_.front())};
    color_.erase(color_.begin(), nearest + 1);
    depth_.pop_front();
    return pair;
  }
  return std::nullopt;
}

}  // namespace sgs::capture
