// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Makes the n-th call of one kind fail, as SQLite's tests do: to be loaded before a program
// (LD_PRELOAD). Calls count from the first opening of a file whose name ends in $SGS_FAULT_FROM.
//
//   SGS_FAULT=KIND:N    the N-th call of KIND fails: memory, large (memory of 64 KiB or more),
//   write,
//                       sync, rename, read or thread; N = 0: none
//   SGS_FAULT_STAYS=1   all later ones of the kind fail, too (a full disk stays full)
//   SGS_FAULT_COUNT=F   at the end the number of calls of KIND goes to file F
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

enum Kind { kNone, kMemory, kLarge, kWrite, kSync, kRename, kRead, kThread };

struct Plan {
  Kind kind = kNone;
  long at = 0;
  bool stays = false;
  const char* from = nullptr;
  const char* count = nullptr;
};

Plan plan;
std::atomic<bool> begun = false;
std::atomic<long> calls = 0;

Kind kind_of(const char* text) {
  const char* const names[] = {"", "memory", "large", "write", "sync", "rename", "read", "thread"};
  for (int k = kMemory; k <= kThread; ++k) {
    const std::size_t length = std::strlen(names[k]);
    if (std::strncmp(text, names[k], length) == 0 && text[length] == ':') return Kind(k);
  }
  return kNone;
}

__attribute__((constructor)) void read_plan() {
  const char* fault = std::getenv("SGS_FAULT");
  if (fault == nullptr) return;
  plan.kind = kind_of(fault);
  plan.at = std::atol(std::strchr(fault, ':') + 1);
  plan.stays = std::getenv("SGS_FAULT_STAYS") != nullptr;
  plan.from = std::getenv("SGS_FAULT_FROM");
  plan.count = std::getenv("SGS_FAULT_COUNT");
  begun = plan.from == nullptr;
}

__attribute__((destructor)) void write_count() {
  if (plan.count == nullptr) return;
  plan.kind = kNone;
  if (std::FILE* file = std::fopen(plan.count, "w")) {
    std::fprintf(file, "%ld\n", calls.load());
    std::fclose(file);
  }
}

bool fails(Kind kind) {
  if (plan.kind != kind || !begun) return false;
  const long call = ++calls;
  return plan.at > 0 && (call == plan.at || (plan.stays && call > plan.at));
}

/// Of an allocation.
bool memory_fails(std::size_t size) {
  constexpr std::size_t kLarge_bytes = 64 << 10;
  return fails(kMemory) || (size >= kLarge_bytes && fails(kLarge));
}

void look_at(const char* path) {
  if (begun || plan.from == nullptr || path == nullptr) return;
  const std::size_t length = std::strlen(path), wanted = std::strlen(plan.from);
  if (length >= wanted && std::strcmp(path + length - wanted, plan.from) == 0) begun = true;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// What is shown on a terminal or in a pipe is not what is lost.
bool is_file(int fd) {
  struct stat info {};
  return ::fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
}

int refuse(int code) {
  errno = code;
  return -1;
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) {
  if (!memory_fails(size)) return __libc_malloc(size);
  errno = ENOMEM;
  return nullptr;
}

void* calloc(std::size_t count, std::size_t size) {
  if (!memory_fails(count * size)) return __libc_calloc(count, size);
  errno = ENOMEM;
  return nullptr;
}

void* realloc(void* block, std::size_t size) {
  if (!memory_fails(size)) return __libc_realloc(block, size);
  errno = ENOMEM;
  return nullptr;
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (!memory_fails(size)) return __libc_memalign(alignment, size);
  errno = ENOMEM;
  return nullptr;
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  if (memory_fails(size)) return ENOMEM;
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}

int open(const char* path, int flags, ...) {
  static const auto real = next<int (*)(const char*, int, ...)>("open");
  std::va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  look_at(path);
  return real(path, flags, mode);
}

ssize_t write(int fd, const void* bytes, std::size_t size) {
  static const auto real = next<ssize_t (*)(int, const void*, std::size_t)>("write");
  if (plan.kind == kWrite && is_file(fd) && fails(kWrite)) return refuse(ENOSPC);
  return real(fd, bytes, size);
}

int fsync(int fd) {
  static const auto real = next<int (*)(int)>("fsync");
  return fails(kSync) ? refuse(EIO) : real(fd);
}

int fdatasync(int fd) {
  static const auto real = next<int (*)(int)>("fdatasync");
  return fails(kSync) ? refuse(EIO) : real(fd);
}

int rename(const char* from, const char* to) {
  static const auto real = next<int (*)(const char*, const char*)>("rename");
  return fails(kRename) ? refuse(ENOSPC) : real(from, to);
}

// Half of what was asked for, which is no failure: the rest must be asked for again.
ssize_t read(int fd, void* bytes, std::size_t size) {
  static const auto real = next<ssize_t (*)(int, void*, std::size_t)>("read");
  const bool is_short = plan.kind == kRead && size > 1 && is_file(fd) && fails(kRead);
  return real(fd, bytes, is_short ? (size + 1) / 2 : size);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*routine)(void*),
                   void* argument) {
  using Real = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto real = next<Real>("pthread_create");
  return fails(kThread) ? EAGAIN : real(thread, attributes, routine, argument);
}

}  // extern "C"
