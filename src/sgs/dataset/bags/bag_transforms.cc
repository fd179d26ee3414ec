// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_transforms.h"

#include <algorithm>
#include <limits>
#include <set>

#include "sgs/bag/messages.h"

namespace sgs::dataset {
namespace {

/// Drivers publish the frames of a camera many times a second.
constexpr std::size_t kFirstMessages = 500;

/// The channels of a tf topic in any namespace; the global one last, which has the last word.
std::vector<std::size_t> tf_channels(const bag::Bag& bag, const std::string& name) {
  std::vector<std::size_t> found;
  for (const bool global : {false, true}) {
    for (std::size_t i = 0; i < bag.channels().size(); ++i) {
      const bag::Channel& channel = bag.channels()[i];
      const bool is_tf = channel.type == "tf2_msgs/TFMessage" || channel.type == "tf/tfMessage";
      const bool is_global = channel.topic == "/" + name || channel.topic == name;
      if (is_tf && channel.topic.ends_with("/" + name) && is_global == global) found.push_back(i);
    }
  }
  return found;
}

}  // namespace

Result<TransformTree> TransformTree::read(const bag::Bag& bag, bool moving) {
  constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  TransformTree tree;
  for (const bool fixed : {true, false}) {
    for (const std::size_t channel : tf_channels(bag, fixed ? "tf_static" : "tf")) {
      tree.add(bag, channel, fixed, fixed || moving ? kAll : kFirstMessages);
    }
  }
  for (auto& [child, edge] : tree.edges_) {
    edge.trajectory = Trajectory(edge.poses);
    edge.fixed = edge.fixed || edge.trajectory.size() == 1;
    edge.poses = {};
  }
  return tree;
}

void TransformTree::add(const bag::TransformMessage& transform, bool fixed) {
  if (transform.child.empty() || transform.child == transform.header.frame_id) return;
  Edge& edge = edges_[transform.child];
  // A frame that is fixed somewhere does not move; a new parent begins anew.
  if (edge.fixed && !fixed) return;
  if (edge.parent != transform.header.frame_id) edge = {transform.header.frame_id, fixed, {}, {}};
  edge.poses.push_back(
      {1e-9 * static_cast<double>(transform.header.stamp_ns), transform.T_parent_child});
}

void TransformTree::add(const bag::Bag& bag, std::size_t channel, bool fixed, std::size_t limit) {
  const bag::Channel& about = bag.channels()[channel];
  const auto cursor = bag.read({channel});
  std::set<std::string> unusable;
  std::size_t unreadable = 0;
  Error first_error;
  for (std::size_t count = 0; count < limit; ++count) {
    const auto message = cursor->next();
    if (message && !*message) break;
    const auto read = message ? bag::read_transforms(**message, about.encoding)
                              : Result<bag::TransformMessages>(tl::unexpected(message.error()));
    if (!read) {
      if (unreadable++ == 0) first_error = read.error();
      continue;
    }
    for (const auto& transform : read->transforms) add(transform, fixed);
    unusable.insert(read->unusable.begin(), read->unusable.end());
  }
  if (unreadable > 0) {
    warnings_.push_back(fmt::format("{}: {} messages left out; the first: {}", about.topic,
                                    unreadable, first_error.message));
  }
  if (!unusable.empty()) {
    warnings_.push_back(
        fmt::format("{}: transforms that are none (NaN, or no unit quaternion) left out, to {}",
                    about.topic, fmt::join(unusable, ", ")));
  }
}

std::string TransformTree::frames() const {
  std::set<std::string> names;
  for (const auto& [child, edge] : edges_) names.insert({child, edge.parent});
  return fmt::format("{}", fmt::join(names, ", "));
}

/// A frame and what it hangs from, up to the root. Ends where a cycle would begin.
std::vector<std::string> TransformTree::ancestors(const std::string& frame) const {
  std::vector<std::string> result = {frame};
  for (auto at = edges_.find(frame); at != edges_.end(); at = edges_.find(result.back())) {
    const std::string& parent = at->second.parent;
    if (std::find(result.begin(), result.end(), parent) != result.end()) break;
    result.push_back(parent);
  }
  return result;
}

std::optional<std::vector<TransformTree::Step>> TransformTree::way(const std::string& to,
                                                                   const std::string& from) const {
  const auto up = ancestors(to), down = ancestors(from);
  for (std::size_t i = 0; i < up.size(); ++i) {
    const auto meet = std::find(down.begin(), down.end(), up[i]);
    if (meet == down.end()) continue;
    std::vector<Step> steps;
    for (std::size_t k = 0; k < i; ++k) steps.push_back({&edges_.at(up[k]), true});
    for (auto it = std::make_reverse_iterator(meet); it != down.rend(); ++it) {
      steps.push_back({&edges_.at(*it), false});
    }
    return steps;
  }
  return std::nullopt;
}

std::optional<SE3> TransformTree::fixed(const std::string& to, const std::string& from) const {
  const auto steps = way(to, from);
  if (!steps) return std::nullopt;
  SE3 T;
  for (const Step& step : *steps) {
    const SE3& T_parent_child = step.edge->trajectory.poses().front().T_world_camera;
    T = T * (step.down ? T_parent_child.inverse() : T_parent_child);
  }
  return T;
}

Trajectory TransformTree::moving(const std::string& to, const std::string& from,
                                 double max_gap_s) const {
  const auto steps = way(to, from);
  if (!steps) return {};
  std::vector<double> times;
  for (const Step& step : *steps) {
    if (step.edge->fixed) continue;
    for (const StampedPose& pose : step.edge->trajectory.poses()) times.push_back(pose.timestamp_s);
  }
  std::vector<StampedPose> result;
  for (const double time : times) {
    SE3 T;
    bool complete = true;
    for (const Step& step : *steps) {
      const Trajectory& known = step.edge->trajectory;
      const auto T_parent_child = step.edge->fixed
                                      ? std::optional(known.poses().front().T_world_camera)
                                      : known.at(time, max_gap_s);
      complete = complete && T_parent_child;
      if (complete) T = T * (step.down ? T_parent_child->inverse() : *T_parent_child);
    }
    if (complete) result.push_back({time, T.normalized()});
  }
  return Trajectory(std::move(result));
}

}  // namespace sgs::dataset
