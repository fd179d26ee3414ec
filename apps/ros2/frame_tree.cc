// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "ros2/frame_tree.h"

#include <utility>

namespace sgs::ros2 {

void FrameTree::add(const std::vector<bag::TransformMessage>& transforms) {
  for (const bag::TransformMessage& transform : transforms) {
    edges_[transform.child] = {transform.header.frame_id, transform.T_parent_child};
  }
}

std::vector<std::pair<std::string, SE3>> FrameTree::above(const std::string& frame) const {
  std::vector<std::pair<std::string, SE3>> way = {{frame, SE3{}}};
  // Not longer than there are edges: they may go in a circle.
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto edge = edges_.find(way.back().first);
    if (edge == edges_.end()) break;
    way.emplace_back(edge->second.parent, edge->second.T_parent_child * way.back().second);
  }
  return way;
}

std::optional<SE3> FrameTree::between(const std::string& to, const std::string& from) const {
  const auto up_from = above(from);
  for (const auto& [frame, T_frame_to] : above(to)) {
    for (const auto& [other, T_other_from] : up_from) {
      if (frame == other) return T_frame_to.inverse() * T_other_from;
    }
  }
  return {};
}

}  // namespace sgs::ros2
