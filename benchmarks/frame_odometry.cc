// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "frame_odometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sgs/core/stopwatch.h"
#include "sgs/dataset/open.h"
#include "sgs/eval/trajectory_metrics.h"

namespace sgs::bench {

int run_frame_odometry(const std::string& label, const std::string& sequence,
                       const std::function<FrameOdometry(const PinholeCamera& camera)>& make) {
  auto opened = dataset::open_sequence(sequence);
  if (!opened) {
    fmt::print(stderr, "{}\n", opened.error().text());
    return 1;
  }
  const FrameOdometry odometry = make(opened->frames->camera());
  SE3 T_world_camera;
  std::vector<eval::PoseEstimate> estimates;
  std::vector<double> spent_ms;
  RgbdFrame frame;
  Error error;
  int failed = 0;
  for (;;) {
    const auto read = opened->frames->next(frame, error);
    if (read == dataset::FrameRead::kEnd) break;
    if (read == dataset::FrameRead::kBadFrame) continue;
    const double start_s = thread_cpu_time_s();
    const std::optional<SE3> T_last_current = odometry(frame);
    spent_ms.push_back(1e3 * (thread_cpu_time_s() - start_s));
    if (!estimates.empty()) {
      if (T_last_current) T_world_camera = T_world_camera * *T_last_current;
      failed += T_last_current ? 0 : 1;
    }
    estimates.push_back({frame.index, frame.timestamp_s, T_world_camera, false});
  }
  if (estimates.empty()) {
    fmt::print(stderr, "{}: no frames\n", sequence);
    return 1;
  }
  const auto metrics = eval::evaluate_trajectory(estimates, opened->frames->ground_truth(), {});
  const auto middle = spent_ms.begin() + static_cast<std::ptrdiff_t>(spent_ms.size() / 2);
  std::nth_element(spent_ms.begin(), middle, spent_ms.end());
  fmt::print("{:<18} {}  ATE {:.2f} cm  {} of {} frames failed  {:.1f} ms CPU per frame (median)\n",
             label, sequence, metrics.ate ? 100 * metrics.ate->rmse : NAN, failed, estimates.size(),
             *middle);
  return 0;
}

}  // namespace sgs::bench
