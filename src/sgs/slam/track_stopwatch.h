// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/stopwatch.h"
#include "sgs/tracker/track_result.h"

namespace sgs::slam {

/// Times the tracker's work on one frame, from construction to note().
class TrackStopwatch {
 public:
  /// Adds stage `track` and its parts to `times` and returns the thread's CPU time in milliseconds.
  /// Stages count CPU time; on the time line `track` takes the wall time, and its parts lie where
  /// they would had nothing interrupted them.
  double note(const tracker::Diagnostics& d, StageTimes& times) const {
    const double cpu_ms = 1e3 * (thread_cpu_time_s() - cpu_start_s_);
    times.add("track", cpu_ms);
    times.add_trace_only("track", wall_start_s_, 1e3 * (wall_time_s() - wall_start_s_));
    double at_s = wall_start_s_;
    const std::pair<const char*, double> parts[] = {{"track/points", d.ms_points},
                                                    {"track/index", d.ms_index},
                                                    {"track/geometry", d.ms_geometry},
                                                    {"track/visual", d.ms_visual},
                                                    {"track/update", d.ms_update}};
    for (const auto& [name, ms] : parts) {
      times.add_interval(name, at_s, ms);
      at_s += 1e-3 * ms;
    }
    return cpu_ms;
  }

 private:
  double wall_start_s_ = wall_time_s();
  double cpu_start_s_ = thread_cpu_time_s();
};

}  // namespace sgs::slam
