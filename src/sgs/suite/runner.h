// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sgs/suite/jobs.h"

namespace sgs::suite {

/// How jobs are made.
struct Runner {
  std::string program;                ///< that the jobs are arguments of
  std::function<bool()> interrupted;  ///< whether the user has asked to stop
  int at_a_time = 1;
  bool again = false;  ///< also what is done already

  /// Makes what is missing of the runs. Every run leaves its own folder, so that an interrupted
  /// suite goes on where it was. What was done, and the last words of what failed, are reported on
  /// stderr. Returns whether every run and every rendering that was begun went well.
  bool run(const std::vector<Job>& jobs) const;
};

}  // namespace sgs::suite
