// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/api/export.h"

namespace sgs::api {

namespace internal {
struct StopAccess;
}

/// A request to end a long call early, from any thread. Copies are the same request.
class SGS_API Stop {
 public:
  Stop();
  Stop(const Stop&);
  Stop& operator=(const Stop&);
  ~Stop();
  void request();
  bool requested() const;

 private:
  friend struct internal::StopAccess;
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sgs::api
