// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/page_pool.h"

#include <sys/mman.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <limits>

namespace sgs {
namespace {

constexpr std::size_t kPageBytes = 4096;  // those of x86-64
constexpr std::size_t kPerOctave = 8;
// Pages are made writable so many at a time.
constexpr std::size_t kStep_pages = (std::size_t{4} << 20) / kPageBytes;

// 1, 2, ... 8 pages, then 9, 10, ... 16, then 18, 20, ... 32, and so on.
std::size_t pages_of_class(std::size_t size_class) {
  if (size_class < kPerOctave) return size_class + 1;
  const std::size_t octave = size_class / kPerOctave - 1, step = size_class % kPerOctave + 1;
  return (kPerOctave + step) << octave;
}

// The smallest class of at least so many pages (one or more).
std::size_t class_of_pages(std::size_t pages) {
  if (pages <= kPerOctave) return pages - 1;
  const auto octave = static_cast<std::size_t>(std::bit_width((pages - 1) / kPerOctave)) - 1;
  const std::size_t unit = std::size_t{1} << octave;
  const std::size_t step = (pages + unit - 1) / unit - kPerOctave;  // 1 to 8
  return (octave + 1) * kPerOctave + step - 1;
}

std::size_t bytes_of_class(std::size_t size_class) {
  return pages_of_class(size_class) * kPageBytes;
}

void* map(std::size_t bytes, int protection) {
  void* block =
      ::mmap(nullptr, bytes, protection, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return block == MAP_FAILED ? nullptr : block;
}

}  // namespace

PagePool::PagePool(std::size_t address_bytes, std::size_t most_free_bytes) noexcept
    : most_free_bytes_(most_free_bytes) {
  const std::size_t pages =
      std::min<std::size_t>(address_bytes / kPageBytes, std::numeric_limits<Page>::max());
  void* addresses = map(pages * kPageBytes, PROT_NONE);
  void* blocks = map(pages * sizeof(Block), PROT_READ | PROT_WRITE);
  if (addresses == nullptr || blocks == nullptr) {
    if (addresses != nullptr) ::munmap(addresses, pages * kPageBytes);
    if (blocks != nullptr) ::munmap(blocks, pages * sizeof(Block));
    return;
  }
  begin_ = static_cast<std::byte*>(addresses);
  end_ = begin_ + pages * kPageBytes;
  blocks_ = static_cast<Block*>(blocks);
}

PagePool::~PagePool() {
  if (begin_ == nullptr) return;
  const auto bytes = static_cast<std::size_t>(end_ - begin_);
  ::munmap(blocks_, bytes / kPageBytes * sizeof(Block));
  ::munmap(begin_, bytes);
}

std::byte* PagePool::address(Page page) const noexcept { return begin_ + page * kPageBytes; }

void* PagePool::allocate(std::size_t bytes) noexcept {
  if (begin_ == nullptr || bytes > static_cast<std::size_t>(end_ - begin_)) return nullptr;
  const std::size_t pages = std::max<std::size_t>(1, (bytes + kPageBytes - 1) / kPageBytes);
  const std::size_t size_class = class_of_pages(pages);
  const std::lock_guard lock(mutex_);
  Page block = waiting_[size_class];
  if (block != 0) {
    stop_waiting(block);
  } else if (block = without_pages_[size_class]; block != 0) {
    without_pages_[size_class] = blocks_[block].next;
  } else if (block = take_from_end(size_class); block == 0) {
    return nullptr;
  }
  blocks_[block].size_class = static_cast<std::uint8_t>(size_class);
  blocks_[block].state = State::kHeld;
  held_bytes_ += bytes_of_class(size_class);
  return address(block);
}

void PagePool::deallocate(void* block) noexcept {
  const auto offset = static_cast<std::size_t>(static_cast<std::byte*>(block) - begin_);
  const auto page = static_cast<Page>(offset / kPageBytes);
  std::unique_lock lock(mutex_);
  if (!owns(block) || offset % kPageBytes != 0 || blocks_[page].state != State::kHeld) std::abort();
  held_bytes_ -= bytes_of_class(blocks_[page].size_class);
  wait(page);
  while (waiting_bytes_ > most_free_bytes_ && oldest_ != 0) return_oldest(lock);
}

PagePool::Page PagePool::take_from_end(std::size_t size_class) noexcept {
  const std::size_t pages = pages_of_class(size_class);
  const auto all = static_cast<std::size_t>(end_ - begin_) / kPageBytes;
  if (pages > all - pages_taken_) return 0;
  const std::size_t end = pages_taken_ + pages;
  if (end > pages_writable_) {
    const std::size_t writable = std::min(std::max(end, pages_writable_ + kStep_pages), all);
    if (::mprotect(begin_ + pages_writable_ * kPageBytes, (writable - pages_writable_) * kPageBytes,
                   PROT_READ | PROT_WRITE) != 0) {
      return 0;
    }
    pages_writable_ = writable;
  }
  const auto block = static_cast<Page>(pages_taken_);
  pages_taken_ = end;
  return block;
}

void PagePool::wait(Page block) noexcept {
  Block& b = blocks_[block];
  b.state = State::kWaiting;
  waiting_bytes_ += bytes_of_class(b.size_class);
  Page& first = waiting_[b.size_class];
  b.previous = 0;
  b.next = first;
  if (first != 0) blocks_[first].previous = block;
  first = block;
  b.newer = 0;
  b.older = newest_;
  (newest_ != 0 ? blocks_[newest_].newer : oldest_) = block;
  newest_ = block;
}

void PagePool::stop_waiting(Page block) noexcept {
  const Block& b = blocks_[block];
  waiting_bytes_ -= bytes_of_class(b.size_class);
  (b.previous != 0 ? blocks_[b.previous].next : waiting_[b.size_class]) = b.next;
  if (b.next != 0) blocks_[b.next].previous = b.previous;
  (b.newer != 0 ? blocks_[b.newer].older : newest_) = b.older;
  (b.older != 0 ? blocks_[b.older].newer : oldest_) = b.newer;
}

void PagePool::return_oldest(std::unique_lock<std::mutex>& lock) noexcept {
  const Page block = oldest_;
  stop_waiting(block);
  const std::size_t size_class = blocks_[block].size_class;
  blocks_[block].state = State::kWithoutPages;
  // Nobody else knows the block now, and others need not wait for the system.
  lock.unlock();
  ::madvise(address(block), bytes_of_class(size_class), MADV_DONTNEED);
  lock.lock();
  blocks_[block].next = without_pages_[size_class];
  without_pages_[size_class] = block;
}

PagePool::Use PagePool::use() const {
  const std::lock_guard lock(mutex_);
  return {held_bytes_, waiting_bytes_, (pages_taken_ - 1) * kPageBytes};
}

}  // namespace sgs
