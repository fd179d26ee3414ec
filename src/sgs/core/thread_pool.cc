// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/thread_pool.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "sgs/core/error.h"

namespace sgs {

struct ThreadPool::State {
  int threads = 1;
  std::vector<std::thread> workers;

  std::mutex mutex;
  std::condition_variable wake, finished;
  // Everything below is guarded by `mutex`, except `next`, which only needs to hand out each chunk
  // once.
  std::uint64_t generation = 0;
  int running = 0;
  bool stop = false;
  int chunks = 0;
  const std::function<void(int, int)>* body = nullptr;
  std::exception_ptr error;
  std::atomic<int> next{0};

  void work(int worker) {
    for (int chunk = next.fetch_add(1); chunk < chunks; chunk = next.fetch_add(1)) {
      try {
        (*body)(chunk, worker);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!error) error = std::current_exception();
        next = chunks;
      }
    }
  }

  void loop(int worker) {
    std::uint64_t seen = 0;
    std::unique_lock lock(mutex);
    while (true) {
      wake.wait(lock, [&] { return stop || generation != seen; });
      if (stop) return;
      seen = generation;
      lock.unlock();
      work(worker);
      lock.lock();
      if (--running == 0) finished.notify_one();
    }
  }
};

ThreadPool::ThreadPool(int threads) : state_(std::make_unique<State>()) {
  SGS_CHECK(threads >= 1, "a thread pool needs at least one thread");
  state_->threads = threads;
  for (int i = 1; i < threads; ++i) {
    state_->workers.emplace_back([s = state_.get(), i] { s->loop(i); });
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::scoped_lock lock(state_->mutex);
    state_->stop = true;
  }
  state_->wake.notify_all();
  for (auto& worker : state_->workers) worker.join();
}

int ThreadPool::threads() const { return state_->threads; }

void ThreadPool::run(int chunks, const std::function<void(int, int)>& body) {
  State& s = *state_;
  if (s.threads == 1 || chunks <= 1) {
    for (int chunk = 0; chunk < chunks; ++chunk) body(chunk, 0);
    return;
  }
  {
    const std::scoped_lock lock(s.mutex);
    s.chunks = chunks;
    s.body = &body;
    s.error = nullptr;
    s.next = 0;
    s.running = s.threads - 1;
    ++s.generation;
  }
  s.wake.notify_all();
  s.work(0);
  std::unique_lock lock(s.mutex);
  s.finished.wait(lock, [&] { return s.running == 0; });
  if (s.error) std::rethrow_exception(s.error);
}

}  // namespace sgs
