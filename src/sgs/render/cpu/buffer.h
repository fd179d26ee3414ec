// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>
#include <utility>

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
  ~Buffer() { ::operator delete(data_, kAlignment); }

  /// Makes room for `size` elements, keeping the first `keep`. New elements are not initialised.
  void ensure(std::size_t size, std::size_t keep = 0) {
    if (size <= capacity_) return;
    const std::size_t capacity = size + size / 2 + 64;
    auto* data = static_cast<T*>(::operator new(capacity * sizeof(T), kAlignment));
    if (keep > 0) std::memcpy(static_cast<void*>(data), data_, keep * sizeof(T));
    ::operator delete(data_, kAlignment);
    data_ = data;
    capacity_ = capacity;
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t capacity() const { return capacity_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  static constexpr std::align_val_t kAlignment{64};
  T* data_ = nullptr;
  std::size_t capacity_ = 0;
};

}  // namespace sgs::render::cpu
