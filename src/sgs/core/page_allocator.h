// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <new>

namespace sgs {

/// Memory of `bytes` that begins with a page: pages of its own where that is worth it, which go back
/// to the system when they are freed. Throws std::bad_alloc.
void* allocate_pages(std::size_t bytes);
/// Frees what allocate_pages(bytes) gave.
void free_pages(void* data, std::size_t bytes) noexcept;

/// Allocator of containers for what is large and lives long. On the heap, with all that comes and
/// goes with each frame around it, such blocks leave holes that nothing else fits into.
template <class T>
struct PageAllocator {
  using value_type = T;

  PageAllocator() = default;
  template <class U>
  explicit(false) PageAllocator(const PageAllocator<U>&) {}  // as containers ask for

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_pages(count * sizeof(T)));
  }
  void deallocate(T* data, std::size_t count) noexcept { free_pages(data, count * sizeof(T)); }

  friend bool operator==(const PageAllocator&, const PageAllocator&) { return true; }
};

}  // namespace sgs
