// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace sgs {

/// Size from which arrays are worth aligning to huge pages, and that alignment.
inline constexpr std::size_t kHugePageBytes = std::size_t{2} << 20;

/// Asks the system to back freshly allocated memory with huge pages where it offers them: arrays of
/// many megabytes that are walked through on every iteration otherwise spend their time in page
/// table look-ups. To be called before the memory is first touched; a no-op for small blocks.
void advise_huge_pages(void* data, std::size_t bytes);

/// std::vector::reserve with huge pages, at least doubling what it has to move.
template <class T>
void reserve_huge(std::vector<T>& values, std::size_t count) {
  if (count <= values.capacity()) return;
  std::vector<T> moved;
  moved.reserve(std::max(count, 2 * values.capacity()));
  advise_huge_pages(moved.data(), moved.capacity() * sizeof(T));
  moved.assign(values.begin(), values.end());
  values = std::move(moved);
}

}  // namespace sgs
