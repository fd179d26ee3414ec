// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/features/hamming_row.h"

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/features/hamming_row.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sgs::features::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void HammingRow(const std::uint8_t* a, const std::uint8_t* b, int count, int* distances) {
  constexpr std::size_t kBytes = 32;
  const hn::CappedTag<std::uint8_t, kBytes> bytes;
  const hn::Repartition<std::uint64_t, decltype(bytes)> words;
  for (int i = 0; i < count; ++i, b += kBytes) {
    auto sum = hn::Zero(words);
    for (std::size_t k = 0; k < kBytes; k += hn::Lanes(bytes)) {
      const auto differ = hn::Xor(hn::LoadU(bytes, a + k), hn::LoadU(bytes, b + k));
      sum = hn::Add(sum, hn::SumsOf8(hn::PopulationCount(differ)));
    }
    distances[i] = static_cast<int>(hn::GetLane(hn::SumOfLanes(words, sum)));
  }
}

}  // namespace sgs::features::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::features {
HWY_EXPORT(HammingRow);

void hamming_row(const std::uint8_t* a, const std::uint8_t* b, int count, int* distances) {
  HWY_DYNAMIC_DISPATCH(HammingRow)(a, b, count, distances);
}

}  // namespace sgs::features
#endif
