// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/floor_plan.h"

#include <algorithm>

#include "sgs/synthetic/scene_builder.h"

namespace sgs::synthetic {

namespace {

using Eigen::AlignedBox2f;
using Eigen::Vector2d;
using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kWallHeight_m = 2.5f, kDoorHeight_m = 2.05f, kDoorWidth_m = 1;
constexpr float kWallThickness_m = 0.1f;

AlignedBox2f box_of(float x0, float y0, float x1, float y1) {
  return {Vector2f(x0, y0), Vector2f(x1, y1)};
}

// Three rooms in a row and a corridor along them. The first two rooms and the corridor make a loop
// of 22 m, all of it one of 50 m; the last metres lead through the first two rooms once more.
FloorPlan flat() {
  return {
      {{box_of(0, 0, 4, 4), true, false, false, 1},
       {box_of(4.1f, 0, 8.1f, 4), true, false, false, 2},
       {box_of(8.2f, 0, 12.2f, 4), true, false, false, 3},
       {box_of(0, 4.1f, 12.2f, 5.7f), false, false, false, 4}},
      {{{1.2f, 4.05f}}, {{5.3f, 4.05f}}, {{11.0f, 4.05f}}, {{4.05f, 3.0f}}},
      {{2.6, 4.9},  {1.2, 4.9},   {1.2, 4.05},  {1.0, 3.2},  {0.9, 0.9},  {3.1, 0.9},  {3.1, 3.0},
       {4.05, 3.0}, {5.0, 3.0},   {5.0, 0.9},   {7.2, 0.9},  {7.2, 3.1},  {5.3, 3.3},  {5.3, 4.05},
       {5.3, 4.9},  {11.0, 4.9},  {11.0, 4.05}, {11.2, 3.1}, {11.3, 0.9}, {9.1, 0.9},  {9.1, 3.1},
       {11.0, 3.2}, {11.0, 4.05}, {11.0, 4.9},  {2.6, 4.9},  {1.2, 4.9},  {1.2, 4.05}, {1.0, 3.2},
       {0.9, 0.9},  {3.1, 0.9},   {3.1, 3.0},   {4.05, 3.0}, {5.0, 3.0},  {5.0, 1.4}}};
}

// Two rooms that are the same to the eye, and the same way through both.
FloorPlan twin_rooms() {
  return {{{box_of(0, 0, 4, 4), true, false, false, 1},
           {box_of(4.1f, 0, 8.1f, 4), true, false, false, 1},
           {box_of(0, 4.1f, 8.1f, 5.7f), false, false, false, 2}},
          {{{1.2f, 4.05f}}, {{5.3f, 4.05f}}},
          {{0.6, 5.0}, {1.2, 4.9},  {1.2, 4.05}, {1.0, 3.2},  {0.9, 0.9},  {3.1, 0.9}, {3.1, 3.1},
           {1.2, 3.3}, {1.2, 4.05}, {1.2, 4.9},  {5.3, 4.9},  {5.3, 4.05}, {5.1, 3.2}, {5.0, 0.9},
           {7.2, 0.9}, {7.2, 3.1},  {5.3, 3.3},  {5.3, 4.05}, {5.3, 4.9},  {7.0, 4.9}}};
}

// A corridor around a block, all of its doors alike, walked one and a third times.
FloorPlan ring() {
  return {{{box_of(0, 0, 9, 9), false, false, true, 1},
           {box_of(1.7f, 1.7f, 7.3f, 7.3f), false, true, true, 2}},
          {},
          {{4.5, 0.85},
           {8.15, 0.85},
           {8.15, 8.15},
           {0.85, 8.15},
           {0.85, 0.85},
           {8.15, 0.85},
           {8.15, 7.0}}};
}

// A wall of a room: where it stands and which way it is looked at.
struct Wall {
  Vector2f from, to;
  Vector2f inward;
};

std::vector<Wall> walls_of(const PlanRoom& room) {
  const Vector2f a = room.area.min(), c = room.area.max(), b(c.x(), a.y()), d(a.x(), c.y());
  // Counter-clockwise: a quad along the wall and downwards faces inwards.
  std::vector<Wall> walls = {{a, b, {0, 1}}, {b, c, {-1, 0}}, {c, d, {0, -1}}, {d, a, {1, 0}}};
  if (!room.solid) return walls;
  for (Wall& wall : walls) {
    std::swap(wall.from, wall.to);
    wall.inward = -wall.inward;
  }
  return walls;
}

/// The openings of a wall, in metres from where it begins.
std::vector<std::pair<float, float>> openings(const Wall& wall, const FloorPlan& plan) {
  const float length = (wall.to - wall.from).norm();
  const Vector2f along = (wall.to - wall.from) / length;
  std::vector<std::pair<float, float>> out;
  for (const PlanDoor& door : plan.doors) {
    const Vector2f d = door.centre - wall.from;
    if (std::abs(d.dot(wall.inward)) > kWallThickness_m) continue;
    const float at = d.dot(along);
    if (at < kDoorWidth_m / 2 || at > length - kDoorWidth_m / 2) continue;
    out.emplace_back(at - kDoorWidth_m / 2, at + kDoorWidth_m / 2);
  }
  std::sort(out.begin(), out.end());
  return out;
}

void build_piece(SceneBuilder& b, const Wall& wall, float left, float right, float low, float high,
                 const Texture* texture) {
  const Vector2f along = (wall.to - wall.from).normalized();
  const Vector2f middle = wall.from + (left + right) / 2 * along;
  b.quad({middle.x(), middle.y(), (low + high) / 2}, {along.x(), along.y(), 0}, -Vector3f::UnitZ(),
         (right - left) / 2, (high - low) / 2, texture, Rgb::Ones());
}

void build_wall(SceneBuilder& b, const Wall& wall, const FloorPlan& plan) {
  const float length = (wall.to - wall.from).norm();
  const Rgb paint = random_color(b.random(), 0.05f, 0.25f, 0.6f, 0.8f);
  float left = 0;
  const auto piece = [&](float right) {
    if (right - left < 0.05f) return;
    build_piece(b, wall, left, right, 0, kWallHeight_m,
                b.posters(right - left, kWallHeight_m, 0.004f, paint, {1.0f, 0.75f, false},
                          Pattern::kPlaster));
  };
  for (const auto& [from, to] : openings(wall, plan)) {
    piece(from);
    build_piece(
        b, wall, from, to, kDoorHeight_m, kWallHeight_m,
        b.painted(kDoorWidth_m, kWallHeight_m - kDoorHeight_m, 0.004f, Pattern::kPlaster, paint));
    left = to;
  }
  piece(length);
}

// Doors that are all the same, evenly spaced.
void build_shut_doors(SceneBuilder& b, const Wall& wall, const Texture* door) {
  constexpr float kEvery_m = 1.85f, kHalf_m = 0.45f;
  const float length = (wall.to - wall.from).norm();
  const Vector2f along = (wall.to - wall.from) / length;
  for (float at = kEvery_m / 2; at + kHalf_m < length; at += kEvery_m) {
    const Vector2f p = wall.from + at * along + 0.02f * wall.inward;
    b.quad({p.x(), p.y(), kDoorHeight_m / 2}, {along.x(), along.y(), 0}, -Vector3f::UnitZ(),
           kHalf_m, kDoorHeight_m / 2, door, Rgb::Ones());
  }
}

// What is seen inside a wall where it is open: two jambs, the lintel and the threshold.
void build_frame(SceneBuilder& b, const PlanDoor& door, bool through_x) {
  const Vector3f across = through_x ? Vector3f::UnitX() : Vector3f::UnitY();
  const Vector3f side = through_x ? Vector3f::UnitY() : Vector3f::UnitX();
  const Vector3f foot(door.centre.x(), door.centre.y(), 0), up = Vector3f::UnitZ();
  const Rgb paint(0.75f, 0.72f, 0.66f);
  for (const float s : {-1.f, 1.f}) {
    b.quad(foot + s * kDoorWidth_m / 2 * side + kDoorHeight_m / 2 * up, across, up,
           kWallThickness_m / 2, kDoorHeight_m / 2, nullptr, paint)
        .two_sided = true;
  }
  for (const float height : {0.f, kDoorHeight_m}) {
    b.quad(foot + height * up, across, side, kWallThickness_m / 2, kDoorWidth_m / 2, nullptr, paint)
        .two_sided = true;
  }
}

void build_plan_room(SceneBuilder& b, const PlanRoom& room, const FloorPlan& plan) {
  const std::vector<Wall> walls = walls_of(room);
  for (const Wall& wall : walls) build_wall(b, wall, plan);
  if (room.doors) {
    const Texture* door =
        b.painted(0.9f, kDoorHeight_m, 0.003f, Pattern::kWood, Rgb(0.55f, 0.4f, 0.28f));
    for (const Wall& wall : walls) build_shut_doors(b, wall, door);
  }
  if (room.solid) return;
  const Vector2f c = room.area.center(), size = room.area.sizes();
  b.quad({c.x(), c.y(), 0}, Vector3f::UnitX(), Vector3f::UnitY(), size.x() / 2, size.y() / 2,
         b.painted(size.x(), size.y(), 0.004f, Pattern::kCarpet,
                   random_color(b.random(), 0.05f, 0.25f, 0.4f, 0.5f)),
         Rgb::Ones());
  b.quad({c.x(), c.y(), kWallHeight_m}, Vector3f::UnitY(), Vector3f::UnitX(), size.y() / 2,
         size.x() / 2, nullptr, Rgb(0.75f, 0.75f, 0.73f));
  if (!room.desk) return;
  b.desk(c, {0.75f, 0.5f}, 14);
  b.clutter_along_walls(room.area, 20);
}

}  // namespace

std::optional<FloorPlan> floor_plan(const std::string& scene) {
  if (scene == "flat") return flat();
  if (scene == "twin_rooms") return twin_rooms();
  if (scene == "ring") return ring();
  return std::nullopt;
}

Walk::Walk(const std::vector<Vector2d>& route) : corners_(route), along_{0} {
  for (std::size_t i = 1; i < route.size(); ++i) {
    along_.push_back(along_.back() + (route[i] - route[i - 1]).norm());
  }
}

Vector2d Walk::on_route(double metres) const {
  const auto after = std::upper_bound(along_.begin() + 1, along_.end() - 1, metres);
  const auto i = static_cast<std::size_t>(after - along_.begin());
  const double share = (metres - along_[i - 1]) / (along_[i] - along_[i - 1]);
  return corners_[i - 1] + share * (corners_[i] - corners_[i - 1]);
}

// A mean over half a metre to either side cuts the corners.
Vector2d Walk::at(double metres) const {
  constexpr int kHalf = 10;
  constexpr double kReach_m = 0.5;
  Vector2d sum = Vector2d::Zero();
  double weights = 0;
  for (int k = -kHalf; k <= kHalf; ++k) {
    const double weight = kHalf + 1 - std::abs(k);
    sum += weight * on_route(metres + kReach_m * k / kHalf);
    weights += weight;
  }
  return sum / weights;
}

Vector2d Walk::ahead(double metres) const {
  const Vector2d here = at(metres);
  Vector2d sum = Vector2d::Zero();
  for (int k = 1; k <= 9; ++k) sum += at(metres + 0.2 * k) - here;
  return sum;
}

void build_floor_plan(SceneBuilder& b, const FloorPlan& plan, std::uint64_t seed) {
  AlignedBox2f all;
  for (const PlanRoom& room : plan.rooms) all.extend(room.area);
  b.lights({all.center().x(), all.center().y(), 0}, all.sizes().maxCoeff() / 4);
  b.scene().ambient = 0.7f;
  b.make_sheets();
  for (const PlanRoom& room : plan.rooms) {
    b.random() = Random(hash64(seed, room.look));
    build_plan_room(b, room, plan);
  }
  const auto is_between_columns = [&](const PlanDoor& door) {
    return std::any_of(plan.rooms.begin(), plan.rooms.end(), [&](const PlanRoom& room) {
      return std::abs(room.area.max().x() - door.centre.x()) < kWallThickness_m;
    });
  };
  for (const PlanDoor& door : plan.doors) build_frame(b, door, is_between_columns(door));
}

}  // namespace sgs::synthetic
