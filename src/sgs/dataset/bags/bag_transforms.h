// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/bag/messages.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::dataset {

/// The tree of coordinate frames in a bag's tf messages.
class TransformTree {
 public:
  /// Reads all of /tf_static and, with `moving`, all of /tf; else only its first messages, which is
  /// enough for frames that do not move against each other. Topics of a robot's own namespace
  /// ("/robot0/tf_static") count as well. Messages and transforms that are unusable are left out.
  static Result<TransformTree> read(const bag::Bag& bag, bool moving);

  bool empty() const { return edges_.empty(); }
  /// What was left out.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// The frames, for messages.
  std::string frames() const;
  /// T_to_from of two frames, with what moves taken at its first time; empty if they are not
  /// joined.
  std::optional<SE3> fixed(const std::string& to, const std::string& from) const;
  /// T_to_from at every time at which a part of the way between them was seen; frames that were not
  /// seen within `max_gap_s` leave a time out. Empty if the frames are not joined.
  Trajectory moving(const std::string& to, const std::string& from, double max_gap_s) const;

 private:
  /// A child and its parent.
  struct Edge {
    std::string parent;
    bool fixed = false;
    std::vector<StampedPose> poses;  ///< T_parent_child
    Trajectory trajectory;           ///< the same, sorted, once all is read
  };
  struct Step {
    const Edge* edge = nullptr;
    bool down = false;  ///< from parent to child
  };
  void add(const bag::Bag& bag, std::size_t channel, bool fixed, std::size_t limit);
  void add(const bag::TransformMessage& transform, bool fixed);
  std::optional<std::vector<Step>> way(const std::string& to, const std::string& from) const;
  std::vector<std::string> ancestors(const std::string& frame) const;

  std::map<std::string, Edge> edges_;  ///< by child
  std::vector<std::string> warnings_;
};

}  // namespace sgs::dataset
