// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/crowd.h"

#include <algorithm>
#include <cmath>

#include "sgs/synthetic/painters.h"
#include "sgs/synthetic/random.h"
#include "sgs/synthetic/ray_caster.h"

namespace sgs::synthetic {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr std::size_t kFigures = 5;
constexpr float kNearest_m = 0.6f;
constexpr float kHalfView = 0.6f;  // of the picture's width at 1 m

// Somebody who crosses the view at about `distance`, up to 1.3 times as far as it reaches.
std::vector<Stop> wander(Random& random, double start_s, double end_s, float distance, float speed,
                         bool from_within) {
  const auto ahead = [&] { return std::max(kNearest_m, distance * random.uniform(0.85f, 1.2f)); };
  float side = random.chance(0.5f) ? 1.f : -1.f;
  const float first = from_within ? 0.2f : 1.2f;
  Vector2f here(-side * first * kHalfView * distance, ahead());
  double t = start_s;
  std::vector<Stop> stops = {{t, here}};
  while (t < end_s) {
    const Vector2f there(side * random.uniform(0.3f, 1.3f) * kHalfView * distance, ahead());
    t += std::max(0.3, double{(there - here).norm() / speed});
    const float luck = random.uniform();
    const bool sits = luck < 0.15f, stands = luck < 0.5f;
    stops.push_back({t, there, sits});
    if (stands) {
      t += double{sits ? random.uniform(2.5f, 4.f) : random.uniform(0.5f, 2.f)};
      stops.push_back({t, there});
    }
    here = there;
    side = -side;
  }
  return stops;
}

// The share of the view, in the mean over the motion, that a crowd takes.
double share_of_view(const Crowd& crowd, const Scene& scene, const Trajectory& motion,
                     ThreadPool& pool) {
  constexpr int kViews = 40;
  constexpr double kMaxGap_s = 1e9;
  const PinholeCamera camera{80, 60, 66.9, 67.4, 39.6, 30.5};
  const double start_s = motion.poses().front().timestamp_s;
  const double length_s = motion.poses().back().timestamp_s - start_s;
  std::size_t covered = 0, all = 0;
  for (int i = 0; i < kViews; ++i) {
    const double t = start_s + (i + 0.5) / kViews * length_s;
    const auto pose = motion.at(t, kMaxGap_s);
    if (!pose) continue;
    const std::vector<Primitive> movers = crowd.at(t);
    RayRequest request{camera, {*pose}};
    request.movers = movers;
    const RayImage seen = cast_rays(scene, request, pool);
    for (const std::uint16_t id : seen.surface)
      covered += id != 0xffff && id >= scene.primitives.size() ? 1 : 0;
    all += seen.surface.size();
  }
  return all > 0 ? static_cast<double>(covered) / static_cast<double>(all) : 0;
}

void append_box(const Vector2f& place, float yaw, const Texture* texture,
                std::vector<Primitive>& out) {
  constexpr float kHalf = 0.28f, kHalfHeight = 0.35f;
  const Vector3f c(place.x(), place.y(), kHalfHeight + 0.01f);
  const Vector3f x(std::cos(yaw), std::sin(yaw), 0), y(-x.y(), x.x(), 0), z = Vector3f::UnitZ();
  const auto side = [&](const Vector3f& centre, const Vector3f& u, const Vector3f& v, float half_u,
                        float half_v) {
    Primitive p;
    p.centre = centre;
    p.u = u;
    p.v = v;
    p.n = u.cross(v);
    p.half_u = half_u;
    p.half_v = half_v;
    p.texture = texture;
    out.push_back(p);
  };
  side(c + kHalfHeight * z, x, y, kHalf, kHalf);
  side(c + kHalf * x, y, z, kHalf, kHalfHeight);
  side(c - kHalf * x, -y, z, kHalf, kHalfHeight);
  side(c + kHalf * y, -x, z, kHalf, kHalfHeight);
  side(c - kHalf * y, x, z, kHalf, kHalfHeight);
}

}  // namespace

Crowd::Crowd(const SynthOptions& options, const Scene& scene, const Trajectory& motion,
             ThreadPool& pool) {
  constexpr float kUsualDistance_m = 1.4f, kNear_m = 0.65f, kFar_m = 4;
  constexpr int kHalvings = 8;
  const std::uint64_t seed = hash64(options.seed, hash_name("crowd"));
  const CrowdOptions& who = options.crowd;
  const Stage stage(motion);
  dress(who.plain, seed);
  enter(who, stage, kUsualDistance_m, seed);
  if (who.view_percent == 0) return;
  float near = kNear_m, far = kFar_m;
  for (int i = 0; i < kHalvings; ++i) {
    const float middle = std::sqrt(near * far);
    enter(who, stage, middle, seed);
    const bool large = 100 * share_of_view(*this, scene, motion, pool) > who.view_percent;
    (large ? near : far) = middle;
  }
}

void Crowd::dress(bool plain, std::uint64_t seed) {
  constexpr float kSize_m = 1.2f, kTexel_m = 0.003f;
  Random random(hash64(seed, 1));
  for (std::size_t i = 0; i < kFigures; ++i) {
    Figure f;
    f.height_m = random.uniform(1.6f, 1.88f);
    const Rgb shirt = random_color(random, 0.2f, 0.7f, 0.35f, 0.85f);
    const Rgb trousers = random_color(random, 0.05f, 0.4f, 0.2f, 0.5f);
    const auto cloth = [&](Pattern pattern, const Rgb& base) {
      Canvas canvas(static_cast<int>(kSize_m / kTexel_m), static_cast<int>(kSize_m / kTexel_m),
                    kTexel_m);
      paint(canvas, pattern, random.bits(), base);
      textures_.emplace_back(std::move(canvas));
      return &textures_.back();
    };
    if (plain) {
      f.shirt_tint = shirt;
      f.trousers_tint = trousers;
    } else {
      f.shirt = cloth(i % 2 == 0 ? Pattern::kPhoto : Pattern::kCarpet, shirt);
      f.trousers = cloth(Pattern::kCarpet, trousers);
    }
    figures_.push_back(f);
  }
}

void Crowd::enter(const CrowdOptions& options, const Stage& stage, float distance,
                  std::uint64_t seed) {
  constexpr std::array<float, 2> kSpeeds = {1.1f, 0.5f};  // m/s
  constexpr float kPercentOfOne = 20, kFollows_m = 1.3f;
  constexpr double kSways_s = 4;
  people_.clear();
  const double start_s = stage.start_s(), end_s = stage.end_s();
  const int walkers =
      static_cast<int>(std::ceil(static_cast<float>(options.view_percent) / kPercentOfOne));
  for (int i = 0; i < walkers; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Random random(hash64(seed, 10 + k));
    const float speed = kSpeeds[k % kSpeeds.size()] * random.uniform(0.9f, 1.1f);
    const float from = std::max(kNearest_m, distance * (1 + 0.15f * static_cast<float>(i)));
    people_.push_back(
        {figure(k), {stage, wander(random, start_s, end_s, from, speed, i == 0), false}});
  }
  if (options.follower) {
    std::vector<Stop> stops;
    float side = 0.1f;
    for (double t = start_s; t < end_s + kSways_s; t += kSways_s, side = -side)
      stops.push_back({t, Vector2f(side, kFollows_m)});
    people_.push_back({figure(3), {stage, stops, true}});
  }
  if (!options.box) return;
  // Somebody waits beside the box, pushes it across the view and walks off.
  constexpr float kHand_m = 0.62f, kAway_m = 2.2f, kTo_m = 0.9f, kFrom_m = -0.5f;
  constexpr double kPush_s = 3.5, kOff_s = 3;
  const double begin_s = start_s + 0.25 * (end_s - start_s), left_s = begin_s + kPush_s;
  const float yaw = stage.towards_camera(begin_s) + 1.5708f;
  // The floor's axes of that moment: the box does not turn with the camera.
  const auto fixed = [&](float right, double) { return stage.in_world({right, kAway_m}, begin_s); };
  if (textures_.empty() || !box_) {
    Canvas canvas(300, 300, 0.003f);
    paint(canvas, Pattern::kPoster, hash64(seed, 5), Rgb(0.7f, 0.55f, 0.35f));
    textures_.emplace_back(std::move(canvas));
    box_.emplace(PushedBox{{}, {}, begin_s, left_s, &textures_.back()});
  }
  box_->from.place = fixed(kFrom_m, begin_s);
  box_->to.place = fixed(kTo_m, left_s);
  box_->from.yaw = box_->to.yaw = yaw;
  const std::vector<Stop> stops = {{start_s, {kFrom_m - kHand_m, kAway_m}},
                                   {begin_s, {kFrom_m - kHand_m, kAway_m}},
                                   {left_s, {kTo_m - kHand_m, kAway_m}},
                                   {left_s + kOff_s, {-2.5f, kAway_m}}};
  people_.push_back({figure(4), {stage, stops, false}});
}

std::vector<Primitive> Crowd::at(double time_s) const {
  std::vector<Primitive> out;
  out.reserve(people_.size() * kBodyParts + 5);
  for (const Person& person : people_) {
    const auto parts = body(person.figure, person.script.at(time_s));
    out.insert(out.end(), parts.begin(), parts.end());
  }
  if (!box_) return out;
  const double share = (time_s - box_->start_s) / (box_->end_s - box_->start_s);
  const float pushed = static_cast<float>(std::clamp(share, 0.0, 1.0));
  append_box(box_->from.place + pushed * (box_->to.place - box_->from.place), box_->from.yaw,
             box_->texture, out);
  return out;
}

std::vector<float> Crowd::steps(double time_s) const {
  constexpr double kInterval_s = 1.0 / 30;
  const std::vector<Primitive> now = at(time_s), before = at(time_s - kInterval_s);
  std::vector<float> out;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Vector3f half = now[i].half_height * now[i].u - before[i].half_height * before[i].u;
    const Vector3f moved = now[i].centre - before[i].centre;
    const bool quad = now[i].kind == Primitive::Kind::kQuad;
    out.push_back(quad ? moved.norm() : std::max((moved + half).norm(), (moved - half).norm()));
  }
  return out;
}

}  // namespace sgs::synthetic
