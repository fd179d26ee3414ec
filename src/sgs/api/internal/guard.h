// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <utility>

#include "sgs/api/error.h"
#include "sgs/core/error.h"

namespace sgs::api::internal {

/// Throws an error of the modules as the library's exception.
[[noreturn]] void raise(const sgs::Error& error);

/// The value of a Result; its error is thrown.
template <class T>
T value_or_raise(sgs::Result<T> result) {
  if (!result) raise(result.error());
  return std::move(*result);
}
inline void check_or_raise(const sgs::Status& status) {
  if (!status) raise(status.error());
}

/// Calls `work`; whatever it throws leaves the library as an api::Error.
template <class Work>
auto guarded(Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (...) {
    raise(sgs::current_error());
  }
}

/// Refuses numbers of threads that cannot be.
void check_threads(int threads);

/// Holds a mutex that only a second thread in the same object can hold: that is refused, as no
/// order of two callers would make sense.
class OneCaller {
 public:
  OneCaller(std::mutex& mutex, const char* what) : lock_(mutex, std::try_to_lock) {
    if (lock_.owns_lock()) return;
    throw Error(ErrorCode::kBusy, std::string("another thread is using this ") + what,
                "use one from one thread at a time, or make one for each thread");
  }

 private:
  std::unique_lock<std::mutex> lock_;
};

}  // namespace sgs::api::internal
