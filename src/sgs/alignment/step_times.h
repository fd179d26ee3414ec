// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/stopwatch.h"

namespace sgs::alignment {

/// CPU time that the steps of one frame took, milliseconds.
struct StepTimes {
  double points = 0, index = 0, geometry = 0, visual = 0, update = 0;
};

/// Adds the CPU time of a scope to a step's.
class CpuTimer {
 public:
  explicit CpuTimer(double& total_ms) : total_ms_(total_ms), start_s_(thread_cpu_time_s()) {}
  ~CpuTimer() { total_ms_ += 1e3 * (thread_cpu_time_s() - start_s_); }
  CpuTimer(const CpuTimer&) = delete;
  CpuTimer& operator=(const CpuTimer&) = delete;

 private:
  double& total_ms_;
  double start_s_;
};

}  // namespace sgs::alignment
