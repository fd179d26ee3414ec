// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs {

/// Keeps a block of memory back for a program that runs out of it. The first `new` that finds no
/// room gets that block's room instead of an exception, and `on_shortage` is told, once, in that
/// thread: it should see to it that the program ends its work soon, with what it has, and may
/// neither allocate nor lock. Later ones throw std::bad_alloc as ever. The way out needs memory,
/// too, and in libraries even destructors do, where an exception would end the program at once.
///
/// For programs, not for libraries: the handler of `new` is one for all. Call it once, before any
/// thread starts. Untouched, the block costs address space only.
void keep_memory_reserve(void (*on_shortage)());

/// Whether the reserve was needed.
bool memory_ran_short();

}  // namespace sgs
