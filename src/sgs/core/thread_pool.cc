// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/thread_pool.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/core/low_priority.h"

namespace sgs {
namespace {

/// How long a thread looks for work before it sleeps: longer than the serial stretches between the
/// loops of one computation, so that those cost no system calls, and far shorter than a frame, so
/// that an idle pool burns nothing.
constexpr std::chrono::microseconds kSpin{100};
/// How long a recess is waited for: several times what a chunk takes.
constexpr std::chrono::milliseconds kLongestChunk{1};

inline void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Polls `ready` for a bounded time; returns its last value.
template <class Ready>
bool spin_until(const Ready& ready) {
  constexpr int kPollsPerLook = 64;
  const auto end = std::chrono::steady_clock::now() + kSpin;
  do {
    for (int i = 0; i < kPollsPerLook; ++i) {
      if (ready()) return true;
      relax();
    }
  } while (std::chrono::steady_clock::now() < end);
  return ready();
}

/// What there is to do, in one word, so that taking a chunk is one compare-and-swap which fails
/// whenever anything about the loop has changed: a thread that comes late can do no harm, and no
/// loop has to wait for threads that slept through it.
struct Work {
  static constexpr int kBits = 24;
  static constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;

  static std::uint64_t pack(std::uint64_t loop, std::uint64_t chunks) {
    return loop << 2 * kBits | chunks << kBits;
  }
  static std::uint64_t chunks(std::uint64_t word) { return word >> kBits & kMask; }
  static std::uint64_t next(std::uint64_t word) { return word & kMask; }
  static bool any(std::uint64_t word) { return next(word) < chunks(word); }
};

}  // namespace

struct ThreadPool::State {
  int threads = 1;
  std::vector<std::thread> workers;

  std::atomic<std::uint64_t> work{0};
  std::uint64_t loop = 0;  // number of the present loop; only run() touches it
  // Written before `work` announces them, read only by threads that hold a chunk.
  const std::function<void(int, int)>* body = nullptr;
  std::atomic<int> unfinished{0};
  std::atomic<bool> failed{false};

  std::mutex mutex;
  std::condition_variable wake, finished;
  std::atomic<int> sleepers{0};
  std::atomic<bool> caller_sleeps{false};
  // A thread at work says so before it looks for a recess, and who wants a recess says so before
  // looking whether that thread is at work: one of the two sees the other.
  std::atomic<int> recesses{0};
  std::atomic<bool> last_at_work{false};
  std::condition_variable rested, resumed;
  bool stop = false;         // guarded by mutex
  std::exception_ptr error;  // guarded by mutex

  void run_chunk(int chunk, int worker) {
    if (!failed.load(std::memory_order_relaxed)) {
      try {
        (*body)(chunk, worker);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!error) error = std::current_exception();
        failed = true;  // the chunks that are left are taken, but not run
      }
    }
    if (unfinished.fetch_sub(1) == 1 && caller_sleeps) {
      const std::scoped_lock lock(mutex);
      finished.notify_one();
    }
  }

  /// Runs chunks until there are none left to take or the worker has a recess.
  void take_all(int worker) {
    const bool last = worker == threads - 1;
    if (last) last_at_work = true;
    std::uint64_t word = work.load();
    while (Work::any(word) && !(last && recesses > 0)) {
      if (!work.compare_exchange_weak(word, word + 1)) continue;
      run_chunk(static_cast<int>(Work::next(word)), worker);
      word = work.load();
    }
    if (!last) return;
    last_at_work = false;
    if (recesses > 0) {
      const std::scoped_lock lock(mutex);
      rested.notify_all();
    }
  }

  void join() {
    {
      const std::scoped_lock lock(mutex);
      stop = true;
    }
    wake.notify_all();
    resumed.notify_all();
    for (auto& worker : workers) worker.join();
  }

  /// Sleeps through recesses; returns whether the pool still exists.
  bool rest() {
    std::unique_lock lock(mutex);
    resumed.wait(lock, [this] { return stop || recesses == 0; });
    return !stop;
  }

  void worker_loop(int worker) {
    const auto has_work = [this] { return Work::any(work.load()); };
    const bool last = worker == threads - 1;
    while (true) {
      if (last && recesses > 0 && !rest()) return;
      if (!spin_until(has_work)) {
        std::unique_lock lock(mutex);
        ++sleepers;
        wake.wait(lock, [&] { return stop || has_work(); });
        --sleepers;
        if (stop) return;
      }
      take_all(worker);
    }
  }
};

ThreadPool::ThreadPool(int threads, int nice) : state_(std::make_unique<State>()) {
  SGS_CHECK(threads >= 1, "a thread pool needs at least one thread");
  state_->threads = threads;
  try {
    for (int i = 1; i < threads; ++i) {
      state_->workers.emplace_back([s = state_.get(), i, nice] {
        if (nice > 0) lower_thread_priority(nice);
        s->worker_loop(i);
      });
    }
  } catch (...) {
    // The system gives no more threads; those that run must end before what they wait on does.
    state_->join();
    throw;
  }
}

ThreadPool::~ThreadPool() { state_->join(); }

int ThreadPool::threads() const { return state_->threads; }

void ThreadPool::run(int chunks, const std::function<void(int, int)>& body) {
  State& s = *state_;
  if (s.threads == 1 || chunks <= 1) {
    for (int chunk = 0; chunk < chunks; ++chunk) body(chunk, 0);
    return;
  }
  SGS_CHECK(static_cast<std::uint64_t>(chunks) < Work::kMask, "too many chunks");
  s.body = &body;
  s.failed = false;
  s.unfinished = chunks;
  s.work = Work::pack(++s.loop, static_cast<std::uint64_t>(chunks));
  // A worker counts itself as sleeping before it looks at `work` for the last time, so one of the
  // two sees the other.
  if (s.sleepers > 0) {
    const std::scoped_lock lock(s.mutex);
    s.wake.notify_all();
  }
  s.take_all(0);
  const auto done = [&s] { return s.unfinished.load() == 0; };
  if (!spin_until(done)) {
    std::unique_lock lock(s.mutex);
    s.caller_sleeps = true;
    s.finished.wait(lock, done);
    s.caller_sleeps = false;
  }
  if (s.failed) {
    const std::scoped_lock lock(s.mutex);
    std::rethrow_exception(std::exchange(s.error, nullptr));
  }
}

ThreadPool::Recess::Recess(ThreadPool& pool) : pool_(pool) {
  State& s = *pool_.state_;
  if (s.threads == 1) return;
  ++s.recesses;
  if (!s.last_at_work) return;
  std::unique_lock lock(s.mutex);
  s.rested.wait_for(lock, kLongestChunk, [&s] { return !s.last_at_work; });
}

ThreadPool::Recess::~Recess() {
  State& s = *pool_.state_;
  if (s.threads == 1 || --s.recesses > 0) return;
  const std::scoped_lock lock(s.mutex);
  s.resumed.notify_one();
}

}  // namespace sgs
