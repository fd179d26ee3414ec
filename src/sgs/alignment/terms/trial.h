// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>

namespace sgs::alignment {

/// How long surface has been seen in one place: what stands in space that was free is on trial
/// until it has stayed. Places are cells of 5 cm in local coordinates. Not thread-safe.
class Trial {
 public:
  explicit Trial(double trial_s) : trial_s_(trial_s) {}

  /// Surface is seen at a point (metres).
  void see(const Eigen::Vector3f& point, double time_s);
  /// Whether surface has been seen around there for the time that it takes.
  bool stayed(const Eigen::Vector3f& point, double time_s) const;
  /// Forgets what has not been seen lately. To be called now and then.
  void forget(double time_s);

 private:
  struct Seen {
    double first_s, last_s;
  };
  double trial_s_;
  std::unordered_map<std::uint64_t, Seen> cells_;
};

}  // namespace sgs::alignment
