// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>
#include <utility>

#include "sgs/core/huge_pages.h"

namespace sgs::render::cpu {

/// Cache-line aligned scratch memory of trivial elements that only ever grows.
template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Buffer() = default;
  Buffer(Buffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), capacity_(std::exchange(other.capacity_, 0)) {}
  Buffer& operator=(Buffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
    return *this;
  }
  ~Buffer() { ::operator delete(data_, alignment(capacity_)); }

  /// Makes room for `size` elements and some more, keeping the first `keep`. New elements are not
  /// initialised.
  void ensure(std::size_t size, std::size_t keep = 0) {
    if (size > capacity_) grow(size + size / 2 + 64, keep);
  }
  /// Makes room for just `size` elements: for what lives long and never grows.
  void ensure_exactly(std::size_t size) {
    if (size > capacity_) grow(size, 0);
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t capacity() const { return capacity_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  void grow(std::size_t capacity, std::size_t keep) {
    auto* data = static_cast<T*>(::operator new(capacity * sizeof(T), alignment(capacity)));
    advise_huge_pages(data, capacity * sizeof(T));
    if (keep > 0) std::memcpy(static_cast<void*>(data), data_, keep * sizeof(T));
    ::operator delete(data_, alignment(capacity_));
    data_ = data;
    capacity_ = capacity;
  }

  static std::align_val_t alignment(std::size_t capacity) {
    constexpr std::size_t kCacheLine = 64;
    return std::align_val_t{capacity * sizeof(T) >= kHugePageBytes ? kHugePageBytes : kCacheLine};
  }

  T* data_ = nullptr;
  std::size_t capacity_ = 0;
};

}  // namespace sgs::render::cpu
