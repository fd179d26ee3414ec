// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/stopwatch.h"
#include "sgs/tracker/track_result.h"

namespace sgs::tracker {

/// CPU time that the steps of one frame took, milliseconds.
struct StepTimes {
  double points = 0, index = 0, geometry = 0, visual = 0, update = 0;

  void write_to(Diagnostics& d) const {
    d.ms_points = points;
    d.ms_index = index;
    d.ms_geometry = geometry;
    d.ms_visual = visual;
    d.ms_update = update;
  }
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

}  // namespace sgs::tracker
