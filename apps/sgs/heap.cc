// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

// What jemalloc, where the program is linked with it, reads before main(). One arena: frames are
// made by one thread and freed by others. Half a minute until free pages go back: most of them are
// used again with the next frames, and a page fault costs more than the page
// (docs/decisions/0050-one-heap.md). NOLINTNEXTLINE: the name is jemalloc's
extern "C" [[gnu::visibility("default")]] const char* malloc_conf;
const char* malloc_conf = "narenas:1,tcache_max:4096,dirty_decay_ms:30000";
