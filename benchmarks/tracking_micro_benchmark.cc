// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The stages of geometric tracking on a depth image of the benchmark room.

#include <benchmark/benchmark.h>

#include "room_scene.h"
#include "sgs/registration/cloud_sampler.h"
#include "sgs/registration/correspondence_search.h"
#include "sgs/registration/geometric_cost.h"

namespace {

using namespace sgs;
using namespace sgs::registration;

DepthImage room_depth(const PinholeCamera& camera) {
  auto rasterizer = render::make_cpu_rasterizer(nullptr);
  render::Rendering seen;
  rasterizer->render(benchmarks::make_room(100000, 0.6), camera, benchmarks::room_pose(), seen);
  DepthImage depth(camera.width, camera.height);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float alpha = seen.alpha.data()[i];
    depth.data()[i] = alpha > 0.9f ? seen.depth_sum.data()[i] / alpha : 0.0f;
  }
  return depth;
}

/// A frame's points and, as the map, those of a denser sampling of the same frame.
struct TrackingRoom {
  PinholeCamera camera = benchmarks::room_camera(640);
  DepthImage depth = room_depth(camera);
  SamplingConfig sampling;
  SourceCloud source;
  TargetCloud target;

  TrackingRoom() {
    sampling.max_depth_m = 10;
    make_sampler(sampling, camera, false)->sample(depth, source);
    SamplingConfig dense = sampling;
    dense.step_px = 4;
    SourceCloud points;
    make_sampler(dense, camera, false)->sample(depth, points);
    for (const SourcePoint& p : points.points) {
      target.points.push_back({p.point, p.normal, p.variance_m2, 1});
    }
  }
};

/// Where the frame is looked for: a little off.
SE3 guess() {
  SE3 T;
  T.t = Eigen::Vector3d(0.01, -0.005, 0.008);
  return T;
}

void PlanesOfAFrame(benchmark::State& state) {
  TrackingRoom room;
  const auto sampler = make_sampler(room.sampling, room.camera, false);
  for (auto _ : state) sampler->sample(room.depth, room.source);
  state.counters["points"] = static_cast<double>(room.source.points.size());
}
BENCHMARK(PlanesOfAFrame)->Unit(benchmark::kMillisecond);

void EllipsesOfAFrame(benchmark::State& state) {
  TrackingRoom room;
  const auto sampler = make_sampler(room.sampling, room.camera, true);
  for (auto _ : state) sampler->sample(room.depth, room.source);
}
BENCHMARK(EllipsesOfAFrame)->Unit(benchmark::kMillisecond);

void IndexOfTheMap(benchmark::State& state) {
  TrackingRoom room;
  const auto search = make_search({}, room.camera);
  for (auto _ : state) search->prepare(room.target, guess());
  state.counters["targets"] = static_cast<double>(room.target.points.size());
}
BENCHMARK(IndexOfTheMap)->Unit(benchmark::kMillisecond);

void Search(benchmark::State& state) {
  TrackingRoom room;
  const auto search = make_search({}, room.camera);
  search->prepare(room.target, SE3());
  std::vector<int> matches;
  for (auto _ : state) search->match(room.source, guess(), matches);
}
BENCHMARK(Search)->Unit(benchmark::kMillisecond);

void SearchAndLinearise(benchmark::State& state) {
  TrackingRoom room;
  const auto search = make_search({}, room.camera);
  search->prepare(room.target, SE3());
  GeometricCost cost({});
  for (auto _ : state) {
    benchmark::DoNotOptimize(cost.linearize(room.source, *search, guess()));
  }
}
BENCHMARK(SearchAndLinearise)->Unit(benchmark::kMillisecond);

}  // namespace
