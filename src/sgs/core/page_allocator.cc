// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/page_allocator.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace sgs {
namespace {

constexpr std::align_val_t kPage{4096};

/// Whether such a block is mapped. A few kilobytes are not worth the call, and sanitizers know the
/// ends of what operator new gives only.
bool is_mapped([[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && !defined(SGS_SANITIZED)
  constexpr std::size_t kWorthIt = 1 << 16;
  return bytes >= kWorthIt;
#else
  return false;
#endif
}

}  // namespace

void* allocate_pages(std::size_t bytes) {
#if defined(__linux__)
  if (is_mapped(bytes)) {
    void* data = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (data == MAP_FAILED) throw std::bad_alloc();
    return data;
  }
#endif
  return ::operator new(bytes, kPage);
}

void free_pages(void* data, std::size_t bytes) noexcept {
#if defined(__linux__)
  if (is_mapped(bytes)) {
    ::munmap(data, bytes);
    return;
  }
#endif
  ::operator delete(data, kPage);
}

}  // namespace sgs
