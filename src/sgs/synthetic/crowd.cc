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

// The way of somebody who walks, stop by stop.
class WanderersWay {
 public:
  WanderersWay(const Stage& stage, float speed, double start_s, const Vector2f& first)
      : stage_(stage), speed_(speed), stops_{{start_s, stage.in_world(first, start_s)}} {}
  double time_s() const { return stops_.back().time_s; }
  const std::vector<Stop>& stops() const { return stops_; }

  /// To where that will be in view on arrival, not over the camera's toes.
  void walk_to(const Vector2f& right_ahead, bool then_sits) {
    const Vector2f here = stops_.back().place;
    const double about_s = time_s() + seconds_to(stage_.in_world(right_ahead, time_s()));
    const Vector2f there = stage_.in_world(right_ahead, about_s);
    const Vector2f eye = stage_.in_world(Vector2f::Zero(), 0.5 * (time_s() + about_s));
    const Vector2f a = here - eye, b = there - eye;
    const float along = std::clamp(a.dot(a - b) / std::max((a - b).squaredNorm(), 1e-6f), 0.f, 1.f);
    if ((a + along * (b - a)).norm() < kNearest_m) {
      Vector2f between = a.stableNormalized() + b.stableNormalized();
      if (between.norm() < 1e-3f) between = Vector2f(-a.y(), a.x());
      go(eye + 0.5f * (a.norm() + b.norm()) * between.normalized(), false);
    }
    go(there, then_sits);
  }
  /// Where they are, whatever the camera does.
  void stay(double seconds) { stops_.push_back({time_s() + seconds, stops_.back().place}); }

 private:
  double seconds_to(const Vector2f& place) const {
    constexpr double kLeast_s = 0.3;
    return std::max(kLeast_s, double{(place - stops_.back().place).norm() / speed_});
  }
  void go(const Vector2f& place, bool sits) {
    stops_.push_back({time_s() + seconds_to(place), place, sits});
  }

  const Stage& stage_;
  float speed_;
  std::vector<Stop> stops_;
};

// Somebody who crosses the view at about `distance`, up to 1.3 times as far as it reaches.
std::vector<Stop> wander(Random& random, const Stage& stage, float distance, float speed,
                         bool from_within) {
  const auto ahead = [&] { return std::max(kNearest_m, distance * random.uniform(0.85f, 1.2f)); };
  float side = random.chance(0.5f) ? 1.f : -1.f;
  const float first = (from_within ? 0.2f : 1.2f) * kHalfView * distance;
  WanderersWay walk(stage, speed, stage.start_s(), {-side * first, ahead()});
  while (walk.time_s() < stage.end_s()) {
    const float depth = ahead();
    const Vector2f there(side * random.uniform(0.3f, 1.3f) * kHalfView * distance, depth);
    const float luck = random.uniform();
    const bool sits = luck < 0.15f, stands = luck < 0.5f;
    walk.walk_to(there, sits);
    if (stands) walk.stay(double{sits ? random.uniform(2.5f, 4.f) : random.uniform(0.5f, 2.f)});
    side = -side;
  }
  return walk.stops();
}

// Somebody who goes where the camera goes, from side to side before it.
std::vector<Stop> follow(const Stage& stage) {
  constexpr float kAhead_m = 1.3f, kAside_m = 0.1f;
  constexpr double kSways_s = 8, kInterval_s = 0.1;
  std::vector<Stop> stops;
  for (double t = stage.start_s(); t < stage.end_s() + kInterval_s; t += kInterval_s) {
    const double turns = (t - stage.start_s()) / kSways_s;
    const double aside = 4 * std::abs(turns - std::round(turns)) - 1;  // -1 .. 1
    stops.push_back({t, stage.in_world({-kAside_m * static_cast<float>(aside), kAhead_m}, t)});
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
  constexpr float kPercentOfOne = 20;
  people_.clear();
  const double start_s = stage.start_s(), end_s = stage.end_s();
  const int walkers =
      static_cast<int>(std::ceil(static_cast<float>(options.view_percent) / kPercentOfOne));
  for (int i = 0; i < walkers; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Random random(hash64(seed, 10 + k));
    const float speed = kSpeeds[k % kSpeeds.size()] * random.uniform(0.9f, 1.1f);
    const float from = std::max(kNearest_m, distance * (1 + 0.15f * static_cast<float>(i)));
    people_.push_back({figure(k), {stage, wander(random, stage, from, speed, i == 0), false}});
  }
  if (options.follower) people_.push_back({figure(3), {stage, follow(stage), true}});
  if (!options.box) return;
  // Somebody waits beside the box, pushes it across the view and walks off.
  constexpr float kHand_m = 0.62f, kAway_m = 2.2f, kTo_m = 0.9f, kFrom_m = -0.5f, kOff_m = -2.5f;
  constexpr double kPush_s = 3.5, kOff_s = 3;
  const double begin_s = start_s + 0.25 * (end_s - start_s), left_s = begin_s + kPush_s;
  const float yaw = stage.towards_camera(begin_s) + 1.5708f;
  // The floor's axes of that moment: the box does not turn with the camera.
  const auto fixed = [&](float right) { return stage.in_world({right, kAway_m}, begin_s); };
  if (textures_.empty() || !box_) {
    Canvas canvas(300, 300, 0.003f);
    paint(canvas, Pattern::kPoster, hash64(seed, 5), Rgb(0.7f, 0.55f, 0.35f));
    textures_.emplace_back(std::move(canvas));
    box_.emplace(PushedBox{{}, {}, begin_s, left_s, &textures_.back()});
  }
  box_->from.place = fixed(kFrom_m);
  box_->to.place = fixed(kTo_m);
  box_->from.yaw = box_->to.yaw = yaw;
  const std::vector<Stop> stops = {{start_s, fixed(kFrom_m - kHand_m)},
                                   {begin_s, fixed(kFrom_m - kHand_m)},
                                   {left_s, fixed(kTo_m - kHand_m)},
                                   {left_s + kOff_s, fixed(kOff_m)}};
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
