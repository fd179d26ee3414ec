// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sgs/bag/messages.h"
#include "sgs/geometry/se3.h"

namespace sgs::ros2 {

/// How frames lie that do not move to each other, as /tf_static says it.
class FrameTree {
 public:
  void add(const std::vector<bag::TransformMessage>& transforms);
  /// T_to_from; empty where nobody has said it.
  std::optional<SE3> between(const std::string& to, const std::string& from) const;

 private:
  struct Edge {
    std::string parent;
    SE3 T_parent_child;
  };
  /// A frame and those above it, each with its own T_above_frame.
  std::vector<std::pair<std::string, SE3>> above(const std::string& frame) const;

  std::map<std::string, Edge> edges_;  // by child
};

}  // namespace sgs::ros2
