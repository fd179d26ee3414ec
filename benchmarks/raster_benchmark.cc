// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// One rasterizer evaluation (L1, colour + depth, backward; no optimiser step) on the furnished
// room: arguments are the number of Gaussians, the image width, the scene (0 room, 1 all in view)
// and the number of threads.

#include <benchmark/benchmark.h>

#include "room_scene.h"

namespace {

using namespace sgs;

void run(benchmark::State& state, float dssim_weight, bool backward) {
  ThreadPool pool(static_cast<int>(state.range(3)));
  auto rasterizer = render::make_cpu_rasterizer(&pool);
  const int count = static_cast<int>(state.range(0));
  const auto gaussians = state.range(2) == 0 ? benchmarks::make_room(count, 0.6)
                                             : benchmarks::make_view_filling(count, 0.6);
  const PinholeCamera camera = benchmarks::room_camera(static_cast<int>(state.range(1)));
  const SE3 pose = benchmarks::room_pose();
  const auto training =
      rasterizer->prepare(benchmarks::disturbed_view(*rasterizer, gaussians, camera, pose));
  render::LossConfig loss;
  loss.dssim_weight = dssim_weight;
  loss.depth_form = render::DepthForm::kAbsolute;
  render::Gradients gradients;
  render::Rendering image;
  for (auto _ : state) {
    if (backward) {
      rasterizer->evaluate(gaussians, *training, pose, loss, gradients);
      benchmark::DoNotOptimize(gradients.gradient.data());
    } else {
      rasterizer->render(gaussians, camera, pose, image);
      benchmark::DoNotOptimize(image.color.data());
    }
  }
  state.counters["visible"] = static_cast<double>(gradients.visible.size());
}

void Evaluate(benchmark::State& state) { run(state, 0.0f, true); }
void EvaluateWithDssim(benchmark::State& state) { run(state, 0.2f, true); }
void Render(benchmark::State& state) { run(state, 0.0f, false); }

#define SGS_RASTER_ARGS \
  ArgNames({"gaussians", "width", "dense", "threads"})->Unit(benchmark::kMillisecond)->UseRealTime()

BENCHMARK(Evaluate)
    ->SGS_RASTER_ARGS->Args({100000, 640, 0, 1})
    ->Args({100000, 640, 0, 2})
    ->Args({100000, 320, 0, 1})
    ->Args({50000, 640, 0, 1})
    ->Args({200000, 640, 0, 1})
    ->Args({100000, 640, 1, 1});
BENCHMARK(EvaluateWithDssim)->SGS_RASTER_ARGS->Args({100000, 640, 0, 1});
BENCHMARK(Render)->SGS_RASTER_ARGS->Args({100000, 640, 0, 1});

}  // namespace

BENCHMARK_MAIN();
