// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Replaces the program's `new` and `delete`: what is large comes from a pool of pages, everything
// else from the C library's heap as ever. A session of hours ends with the memory that it holds,
// instead of that and the gaps between (docs/decisions/0052-pages-apart.md). SGS_PAGE_POOL=0 in the
// environment turns it off for tools that watch allocations. Not part of builds with sanitizers,
// nor of the libraries: there is one `new` in a program, and it is the program's.
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>

#include "sgs/core/page_pool.h"

namespace {

constexpr std::size_t kLarge_bytes = std::size_t{64} << 10;
constexpr std::size_t kPage_bytes = 4096;
// Addresses only; whoever needs more gets the rest from the heap.
constexpr std::size_t kAddress_bytes = std::size_t{16} << 30;
// What a frame takes and gives back, and some more: with 64 MiB half of the room was given to the
// system and asked back all the time.
constexpr std::size_t kMostFree_bytes = std::size_t{144} << 20;

bool wanted() {
  const char* value = std::getenv("SGS_PAGE_POOL");
  return value == nullptr || std::strcmp(value, "0") != 0;
}

sgs::PagePool& pool() {
  // Never destroyed: what static objects hold is given back after everything else.
  alignas(sgs::PagePool) static std::byte storage[sizeof(sgs::PagePool)];
  static auto* pool = new (storage) sgs::PagePool(wanted() ? kAddress_bytes : 0, kMostFree_bytes);
  return *pool;
}

void* try_once(std::size_t bytes, std::size_t alignment) {
  if (bytes >= kLarge_bytes && alignment <= kPage_bytes) {
    if (void* block = pool().allocate(bytes)) return block;
  }
  if (bytes == 0) bytes = 1;
  if (alignment <= alignof(std::max_align_t)) return std::malloc(bytes);
  void* block = nullptr;
  return ::posix_memalign(&block, alignment, bytes) == 0 ? block : nullptr;
}

void* allocate(std::size_t bytes, std::size_t alignment) {
  for (;;) {
    if (void* block = try_once(bytes, alignment)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void deallocate(void* block) noexcept {
  if (block != nullptr && pool().owns(block)) {
    pool().deallocate(block);
  } else {
    std::free(block);
  }
}

}  // namespace

// The forms for arrays and those that do not throw call these.
void* operator new(std::size_t bytes) { return allocate(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* block) noexcept { deallocate(block); }
void operator delete(void* block, std::size_t) noexcept { deallocate(block); }
void operator delete(void* block, std::align_val_t) noexcept { deallocate(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { deallocate(block); }
