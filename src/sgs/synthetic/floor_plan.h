// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sgs/geometry/se3.h"

namespace sgs::synthetic {

class SceneBuilder;

/// A rectangle with walls. Metres, floor at z = 0.
struct PlanRoom {
  Eigen::AlignedBox2f area;
  bool desk = false;       ///< a desk in the middle and clutter along the walls
  bool solid = false;      ///< a block that is walked around: walls face outwards, no floor inside
  bool doors = false;      ///< shut doors along the walls, one like the other
  std::uint64_t look = 0;  ///< rooms of the same size and look are the same to the eye
};

/// An opening of 1 m in the walls next to it.
struct PlanDoor {
  Eigen::Vector2f centre;
};

/// Rooms, the openings between them, and the way somebody walks through with a camera.
struct FloorPlan {
  std::vector<PlanRoom> rooms;
  std::vector<PlanDoor> doors;
  std::vector<Eigen::Vector2d> route;  ///< corners of the way
};

/// The plan of a scene that has one: "flat", "twin_rooms" or "ring".
std::optional<FloorPlan> floor_plan(const std::string& scene);

/// The way along a route, its corners cut, at an even pace.
class Walk {
 public:
  explicit Walk(const std::vector<Eigen::Vector2d>& route);
  double length_m() const { return along_.back(); }
  /// Position after so many metres; the ends continue straight on.
  Eigen::Vector2d at(double metres) const;
  /// Where somebody looks who walks there: towards the next two metres of the way.
  Eigen::Vector2d ahead(double metres) const;

 private:
  Eigen::Vector2d on_route(double metres) const;
  std::vector<Eigen::Vector2d> corners_;
  std::vector<double> along_;  // metres to each corner
};

/// Builds the rooms of a plan.
void build_floor_plan(SceneBuilder& builder, const FloorPlan& plan, std::uint64_t seed);

}  // namespace sgs::synthetic
