// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "sgs/tracker/test_drifting_tracker.h"

namespace sgs::benchmarks {

/// The drift that a benchmark was asked to add to a tracker's poses.
struct InjectedDrift {
  bool walk = false, bias = false;

  void declare(CLI::App& app) {
    app.add_flag("--drift", walk, "Add a random walk of 1 cm and 0.5 degrees after one metre.");
    app.add_flag("--bias", bias, "Add a drift of 1 % and 0.5 degrees per metre.");
  }
  /// The tracker itself where nothing is to be added.
  std::unique_ptr<tracker::Tracker> onto(std::unique_ptr<tracker::Tracker> tracker,
                                         std::uint64_t seed) const {
    if (!walk && !bias) return tracker;
    tracker::DriftingTracker::Drift drift;
    if (!walk) drift.translation_m = drift.rotation_deg = 0;
    if (bias) {
      drift.length_ratio = 0.01;
      drift.turn_deg = 0.5;
    }
    return std::make_unique<tracker::DriftingTracker>(std::move(tracker), drift, seed);
  }
};

}  // namespace sgs::benchmarks
