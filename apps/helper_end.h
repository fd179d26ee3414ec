// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>

#include "sgs/core/error.h"
#include "sgs/core/print.h"
#include "sgs/run/exit_code.h"

namespace sgs::app {

/// How a program ends that `sgs` starts (sgs/helper_program.h reads it): what went wrong goes to
/// standard output, message and remedy on a line each. Returns the exit code.
inline int end_helper(const Status& status) {
  if (status) return run::kExitDone;
  print("{}\n{}\n", status.error().message, status.error().remedy);
  std::fflush(stdout);
  return status.error().code == ErrorCode::kInvalidArgument ? run::kExitUsage : run::kExitFailed;
}

}  // namespace sgs::app
