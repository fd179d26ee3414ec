// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sgs/suite/jobs.h"

namespace sgs::suite {

/// How jobs are made. Any number of workers, on this machine and others, may do so in the same
/// folders at the same time: each run and each rendering is claimed before it is begun
/// (suite/claim.h), made in a folder of its own and moved to its place in one step, so that it is
/// there once and whole.
struct Runner {
  std::string program;                ///< that the jobs are arguments of
  std::function<bool()> interrupted;  ///< whether the user has asked to stop
  int at_a_time = 1;
  bool again = false;    ///< also what is done already
  double lease_s = 120;  ///< a worker without a sign of life for so long is taken for dead

  /// Makes what is missing of the runs, and waits for those that others are making. A suite that is
  /// interrupted goes on where it was. What was done, and the last words of what failed, are
  /// reported on stderr. Returns whether all went well.
  bool run(const std::vector<Job>& jobs) const;
};

}  // namespace sgs::suite
