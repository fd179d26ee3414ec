// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>

namespace sgs {

/// Blocks of whole pages for what is large and comes and goes (images), in a stretch of addresses
/// of their own. In a heap they leave gaps between what lives long, which others fit into only in
/// part.
///
/// Sizes are rounded up to one of eight per octave. Blocks that are given back wait for the next
/// request of their size, the last one first; when more than `most_free_bytes` wait, those that
/// have waited longest return their pages to the system, and keep the addresses. So memory is at
/// most what is held, rounded up, and that much; and recycled blocks cost no page faults.
///
/// Thread-safe. It allocates nothing itself and writes nothing into the blocks.
class PagePool {
 public:
  /// Takes `address_bytes` of address space, no memory. Where that is not to be had (a limit of the
  /// process), the pool has no blocks.
  PagePool(std::size_t address_bytes, std::size_t most_free_bytes) noexcept;
  /// Nothing may be held any more.
  ~PagePool();
  PagePool(const PagePool&) = delete;
  PagePool& operator=(const PagePool&) = delete;

  /// A block of at least `bytes` that begins with a page; its content is anything. Null where there
  /// are no addresses or no memory left.
  void* allocate(std::size_t bytes) noexcept;
  /// Whether the block is one of this pool: costs two comparisons.
  bool owns(const void* block) const noexcept {
    const auto* address = static_cast<const std::byte*>(block);
    return address >= begin_ && address < end_;
  }
  /// Takes back what allocate() gave; anything else ends the program.
  void deallocate(void* block) noexcept;

  /// Bytes, in whole pages.
  struct Use {
    std::size_t held = 0;       ///< by those who asked for them
    std::size_t waiting = 0;    ///< given back, to be used again
    std::size_t addresses = 0;  ///< taken so far, those without pages included
  };
  Use use() const;

 private:
  using Page = std::uint32_t;  // counted from begin_; 0 is none, and no block
  enum class State : std::uint8_t { kNone, kHeld, kWaiting, kWithoutPages };
  /// Of a block, at the index of its first page; links are to first pages.
  struct Block {
    Page next = 0, previous = 0;  // of the same size and state
    Page newer = 0, older = 0;    // of those that wait, by when they came
    std::uint8_t size_class = 0;
    State state = State::kNone;
  };
  static constexpr std::size_t kSizeClasses = 256;

  Page take_from_end(std::size_t size_class) noexcept;
  void wait(Page block) noexcept;
  void stop_waiting(Page block) noexcept;
  void return_oldest(std::unique_lock<std::mutex>& lock) noexcept;
  std::byte* address(Page page) const noexcept;

  std::byte* begin_ = nullptr;
  std::byte* end_ = nullptr;
  Block* blocks_ = nullptr;  // one for each page; untouched ones take no memory
  std::size_t most_free_bytes_;

  mutable std::mutex mutex_;
  std::size_t pages_taken_ = 1;     // from begin_
  std::size_t pages_writable_ = 0;  // from begin_
  std::size_t held_bytes_ = 0, waiting_bytes_ = 0;
  std::array<Page, kSizeClasses> waiting_{}, without_pages_{};
  Page newest_ = 0, oldest_ = 0;
};

}  // namespace sgs
