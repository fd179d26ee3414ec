// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace sgs::dataset {

/// What the numbers of a list of times count.
struct TimeUnit {
  double per_second = 1;  ///< of them
  std::string name;       ///< "nanoseconds", ...; empty for seconds
  bool known = true;      ///< false for frame numbers: how many make a second is a guess
};

/// Recognises the unit of times: those since 1970 by their size, others by their steps, where all
/// are written as whole numbers (`whole`). Numbers that go by one count frames, 30 a second. What
/// can be seconds is taken for seconds.
TimeUnit unit_of_times(std::vector<double> times, bool whole);

/// Half of the steps between sorted times are smaller, half larger; 0 for fewer than two times.
double median_step(const std::vector<double>& sorted);

/// Whether sorted times go by one step, as those of a camera do; gaps may lie between them.
bool steps_evenly(const std::vector<double>& sorted);

/// Whether so many seconds between two images are no pause of a recording, but a clock that was
/// set.
bool is_no_pause(double gap_s);

/// The words for a clock that was set ahead between two images.
std::string clock_set_ahead(double before_s, double after_s);

}  // namespace sgs::dataset
