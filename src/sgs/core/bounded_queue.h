// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace sgs {

/// What push() does when the queue is full.
enum class FullPolicy {
  kBlock,       ///< wait for room: offline runs lose nothing
  kDropOldest,  ///< discard the oldest element and count it: live runs stay current
};

/// Bounded multi-producer multi-consumer queue between pipeline stages. Thread-safe. Takes its
/// memory when it is made: a push() never fails for lack of it, which no thread's loop would
/// survive.
template <class T>
class BoundedQueue {
 public:
  BoundedQueue(std::size_t capacity, FullPolicy policy) : places_(capacity), policy_(policy) {}

  /// Adds an element; returns false when the queue is closed (the element is discarded).
  bool push(T value) {
    std::unique_lock lock(mutex_);
    if (policy_ == FullPolicy::kBlock) {
      not_full_.wait(lock, [&] { return closed_ || count_ < places_.size(); });
    }
    if (closed_) return false;
    if (count_ == places_.size()) {
      remove_first();
      ++dropped_;
    }
    places_[(first_ + count_) % places_.size()] = std::move(value);
    ++count_;
    not_empty_.notify_one();
    return true;
  }

  /// Takes the oldest element, waiting for one; empty when the queue is closed and drained.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    not_empty_.wait(lock, [&] { return closed_ || count_ > 0; });
    return take();
  }

  /// Takes the oldest element if there is one; never waits.
  std::optional<T> try_pop() {
    std::unique_lock lock(mutex_);
    return take();
  }

  /// Wakes all waiters; later pushes are refused, elements already queued can still be popped.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    not_empty_.notify_all();
    not_full_.notify_all();
  }

  /// Number of elements discarded by kDropOldest so far.
  std::size_t dropped() const {
    const std::scoped_lock lock(mutex_);
    return dropped_;
  }

  std::size_t size() const {
    const std::scoped_lock lock(mutex_);
    return count_;
  }

 private:
  std::optional<T> take() {
    if (count_ == 0) return std::nullopt;
    std::optional<T> value = remove_first();
    not_full_.notify_one();
    return value;
  }
  std::optional<T> remove_first() {
    std::optional<T> value = std::exchange(places_[first_], std::nullopt);
    first_ = (first_ + 1) % places_.size();
    --count_;
    return value;
  }

  mutable std::mutex mutex_;
  std::condition_variable not_empty_, not_full_;
  std::vector<std::optional<T>> places_;  // a ring of `count_` elements from `first_` on
  std::size_t first_ = 0, count_ = 0;
  std::size_t dropped_ = 0;
  FullPolicy policy_;
  bool closed_ = false;
};

}  // namespace sgs
