// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/run_observer.h"

namespace sgs::run {

RunObserver& RunObserver::nobody() {
  static RunObserver nobody;  // without state
  return nobody;
}

}  // namespace sgs::run
