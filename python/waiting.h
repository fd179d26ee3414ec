// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <functional>
#include <future>
#include <mutex>
#include <utility>
#include <vector>

namespace sgs::python {

namespace py = pybind11;

/// Work that nobody waits for any more; at its end the program does.
template <class T>
void abandon(std::future<T> work) {
  static std::mutex mutex;
  static std::vector<std::future<T>> abandoned;
  const std::lock_guard lock(mutex);
  abandoned.push_back(std::move(work));
}

/// Does long work on a thread of its own, with Python free meanwhile, so that Ctrl-C comes through:
/// then `stop` is to end the work soon. Work that cannot be stopped (no `stop`) is left to itself
/// and must own what it uses.
template <class Work>
auto interruptible(Work work, const std::function<void()>& stop) -> decltype(work()) {
  constexpr std::chrono::milliseconds kLook(50);
  auto future = std::async(std::launch::async, std::move(work));
  bool interrupted = false;
  {
    const py::gil_scoped_release free_python;
    while (!interrupted && future.wait_for(kLook) != std::future_status::ready) {
      const py::gil_scoped_acquire hold_python;
      interrupted = PyErr_CheckSignals() != 0;
    }
    if (interrupted && stop) {
      stop();
      future.wait();
    }
  }
  if (!interrupted) return future.get();
  if (!stop) abandon(std::move(future));
  throw py::error_already_set();
}

}  // namespace sgs::python
