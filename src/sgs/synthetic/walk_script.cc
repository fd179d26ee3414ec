// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/walk_script.h"

#include <algorithm>
#include <cmath>

namespace sgs::synthetic {

namespace {

using Eigen::Vector2f;
using Eigen::Vector4f;

constexpr double kViewRate_hz = 10, kPostureRate_hz = 60;
constexpr float kPi = 3.14159265f;

// Means over so many neighbours on either side, fewer at the ends.
std::vector<Vector4f> evened(const std::vector<Vector4f>& in, int side) {
  std::vector<Vector4f> out(in.size());
  const int n = static_cast<int>(in.size());
  for (int i = 0; i < n; ++i) {
    const int half = std::min({side, i, n - 1 - i});
    Vector4f sum = Vector4f::Zero();
    for (int k = i - half; k <= i + half; ++k) sum += in[static_cast<std::size_t>(k)];
    out[static_cast<std::size_t>(i)] = sum / static_cast<float>(2 * half + 1);
  }
  return out;
}

// The place among values at a fixed rate: the one before, and the share of the one after.
struct Between {
  std::size_t i;
  float share;
  Between(double time_s, double start_s, double rate_hz, std::size_t count) {
    const double x =
        std::clamp((time_s - start_s) * rate_hz, 0.0, static_cast<double>(count - 1) - 1e-6);
    i = static_cast<std::size_t>(std::max(0.0, x));
    share = static_cast<float>(x - static_cast<double>(i));
  }
};

Vector2f on_way(const std::vector<Stop>& stops, double time_s) {
  const auto next = std::find_if(stops.begin(), stops.end(),
                                 [&](const Stop& stop) { return stop.time_s > time_s; });
  if (next == stops.begin()) return stops.front().place;
  if (next == stops.end()) return stops.back().place;
  const Stop& last = *std::prev(next);
  const float share = static_cast<float>((time_s - last.time_s) / (next->time_s - last.time_s));
  return last.place + share * (next->place - last.place);
}

// Corners cut: nobody stops dead.
Vector2f evened_way(const std::vector<Stop>& stops, double time_s) {
  Vector2f sum = Vector2f::Zero();
  for (const double offset : {-0.24, -0.12, 0.0, 0.12, 0.24}) sum += on_way(stops, time_s + offset);
  return sum / 5;
}

bool sits_at(const std::vector<Stop>& stops, double time_s) {
  const auto next = std::find_if(stops.begin(), stops.end(),
                                 [&](const Stop& stop) { return stop.time_s > time_s; });
  return next != stops.begin() && std::prev(next)->sits;
}

float nearest_turn(float wanted, float now) { return now + std::remainder(wanted - now, 2 * kPi); }

}  // namespace

Stage::Stage(const Trajectory& motion) {
  constexpr int kEvened = 15;
  constexpr double kMaxGap_s = 1e9;
  const auto& poses = motion.poses();
  start_s_ = poses.front().timestamp_s;
  for (double t = start_s_; t <= poses.back().timestamp_s; t += 1 / kViewRate_hz) {
    const auto pose = motion.at(t, kMaxGap_s);
    if (!pose) continue;
    Eigen::Vector2d ahead = pose->R.col(2).head<2>();
    if (ahead.norm() > 1e-3) ahead.normalize();
    views_.push_back(Eigen::Vector4d(pose->t.x(), pose->t.y(), ahead.x(), ahead.y()).cast<float>());
  }
  views_ = evened(evened(views_, kEvened), kEvened);
}

double Stage::end_s() const {
  return start_s_ + static_cast<double>(views_.size() - 1) / kViewRate_hz;
}

Vector4f Stage::at(double time_s) const {
  if (views_.size() == 1) return views_.front();
  const Between b(time_s, start_s_, kViewRate_hz, views_.size());
  return views_[b.i] + b.share * (views_[b.i + 1] - views_[b.i]);
}

Vector2f Stage::in_world(const Vector2f& right_ahead, double time_s) const {
  const Vector4f view = at(time_s);
  Vector2f ahead = view.tail<2>();
  ahead = ahead.norm() > 1e-3f ? Vector2f(ahead.normalized()) : Vector2f(Vector2f::UnitX());
  const Vector2f right(ahead.y(), -ahead.x());
  return view.head<2>() + right_ahead.x() * right + right_ahead.y() * ahead;
}

float Stage::towards_camera(double time_s) const {
  const Vector4f view = at(time_s);
  return std::atan2(-view.w(), -view.z());
}

WalkScript::WalkScript(const Stage& stage, const std::vector<Stop>& stops, bool faces_camera)
    : start_s_(stage.start_s()) {
  constexpr float kStep_s = 1 / static_cast<float>(kPostureRate_hz);
  constexpr float kSlow = 0.15f, kBrisk = 1.2f, kStride_m = 1.3f;    // m/s; of two steps
  constexpr float kTurning = 5, kSittingDown = 1.2f, kChanging = 3;  // a second
  Posture now;
  now.yaw = stage.towards_camera(start_s_);
  now.place = evened_way(stops, start_s_);
  for (double t = start_s_; t <= stage.end_s(); t += 1 / kPostureRate_hz) {
    const Vector2f place = evened_way(stops, t);
    const Vector2f velocity = (place - now.place) / kStep_s;
    const float speed = velocity.norm();
    const bool sits = sits_at(stops, t);
    float wanted = now.yaw;
    if (faces_camera || sits)
      wanted = stage.towards_camera(t);
    else if (speed > kSlow)
      wanted = std::atan2(velocity.y(), velocity.x());
    const auto towards = [&](float value, float aim, float rate) {
      return value + std::clamp(aim - value, -rate * kStep_s, rate * kStep_s);
    };
    now.yaw = towards(now.yaw, nearest_turn(wanted, now.yaw), kTurning);
    now.stride = towards(now.stride, std::min(1.f, speed / kBrisk), kChanging);
    now.sitting = towards(now.sitting, sits ? 1.f : 0.f, kSittingDown);
    now.phase += 2 * kPi * speed * kStep_s / kStride_m;
    now.place = place;
    postures_.push_back(now);
  }
}

Posture WalkScript::at(double time_s) const {
  if (postures_.size() == 1) return postures_.front();
  const Between b(time_s, start_s_, kPostureRate_hz, postures_.size());
  const Posture &p = postures_[b.i], &q = postures_[b.i + 1];
  const auto mix = [&](auto x, auto y) { return x + b.share * (y - x); };
  return {p.place + b.share * (q.place - p.place), mix(p.yaw, q.yaw), mix(p.phase, q.phase),
          mix(p.stride, q.stride), mix(p.sitting, q.sitting)};
}

}  // namespace sgs::synthetic
