// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/memory_reserve.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace sgs {
namespace {

constexpr std::size_t kReserve_bytes = std::size_t{32} << 20;

std::atomic<void*> memory_reserve = nullptr;
std::atomic<bool> reserve_used = false;
void (*tell_of_shortage)() = nullptr;

// Called by `new`, which tries again when this returns.
void use_reserve() {
  void* block = memory_reserve.exchange(nullptr);
  if (block == nullptr) throw std::bad_alloc();
  std::free(block);
  reserve_used = true;
  tell_of_shortage();
}

}  // namespace

void keep_memory_reserve(void (*on_shortage)()) {
  tell_of_shortage = on_shortage;
  memory_reserve = std::malloc(kReserve_bytes);
  std::set_new_handler(use_reserve);
}

bool memory_ran_short() { return reserve_used; }

}  // namespace sgs
