// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The stages of a mapping iteration one by one, on the benchmark room (100k Gaussians, 640x480, one
// thread).

#include <benchmark/benchmark.h>

#include <cmath>
#include <numeric>

#include "room_scene.h"
#include "sgs/map/gaussian_store.h"
#include "sgs/mapper/optimizer.h"
#include "sgs/render/cpu/buffer.h"
#include "sgs/render/cpu/project.h"
#include "sgs/render/cpu/sort_bin.h"
#include "sgs/render/cpu/ssim.h"
#include "sgs/render/cpu/tiled_image.h"

namespace {

using namespace sgs;
using namespace sgs::render::cpu;

constexpr int kGaussians = 100000, kWidth = 640;

/// Projects all Gaussians into buffers laid out as the rasterizer's.
struct ProjectedRoom {
  std::vector<map::Gaussian> gaussians = benchmarks::make_room(kGaussians, 0.6);
  PinholeCamera camera = benchmarks::room_camera(kWidth);
  render::View<float> view = render::make_view<float>(camera, benchmarks::room_pose());
  Buffer<Record> records;
  Buffer<std::uint32_t> keys, trained, first_slot;
  Buffer<TileRect> rects;
  std::vector<std::uint32_t> visible;

  ProjectedRoom() {
    const std::size_t capacity = gaussians.size() + kChunk;
    records.ensure(capacity);
    keys.ensure(capacity);
    trained.ensure(capacity);
    rects.ensure(capacity);
    first_slot.ensure(capacity);
    project();
  }
  void project() {
    visible.clear();
    for (std::size_t first = 0; first < gaussians.size(); first += kChunk) {
      std::vector<std::uint32_t> indices(std::min<std::size_t>(kChunk, gaussians.size() - first));
      std::iota(indices.begin(), indices.end(), static_cast<std::uint32_t>(first));
      const ChunkCount found =
          project_chunk(view, gaussians.data(), indices,
                        {records.data() + first, keys.data() + first, rects.data() + first,
                         trained.data() + first, first_slot.data() + first});
      visible.push_back(found.visible);
    }
  }
};

void Projection(benchmark::State& state) {
  ProjectedRoom room;
  for (auto _ : state) room.project();
}
BENCHMARK(Projection)->Unit(benchmark::kMillisecond);

void SortAndBin(benchmark::State& state) {
  ProjectedRoom room;
  const TileGrid grid(room.camera.width, room.camera.height);
  ThreadPool pool(1);
  TileLists lists;
  for (auto _ : state) {
    lists.build(room.visible, room.keys.data(), room.rects.data(), grid.tiles_x, grid.tiles_y,
                pool);
    benchmark::DoNotOptimize(lists.tile(0).data());
  }
}
BENCHMARK(SortAndBin)->Unit(benchmark::kMillisecond);

void Adam(benchmark::State& state) {
  map::GaussianStore store;
  const auto room = benchmarks::make_room(kGaussians, 0.6);
  mapper::reserve(store, room.size());
  for (const auto& g : room) store.append(g, {}, 1e6f);
  std::vector<std::uint32_t> visible;  // every other stretch, 40 % of all
  for (std::uint32_t i = 0; i < room.size(); ++i) {
    if (i / 1000 % 5 < 2) visible.push_back(i);
  }
  const std::vector<map::Gaussian> gradient(visible.size(), room[0]);
  const mapper::Optimizer optimizer({});
  for (auto _ : state) optimizer.step(visible, gradient.data(), store);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(visible.size()));
}
BENCHMARK(Adam)->Unit(benchmark::kMillisecond);

void DssimOfOneChannel(benchmark::State& state) {
  constexpr int kHeight = 480;
  PaddedPlane x(kWidth, kHeight), y(kWidth, kHeight), gradient;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      x.row(row)[column] = 0.5f + 0.4f * std::sin(0.1f * static_cast<float>(column + row));
      y.row(row)[column] = 0.5f + 0.4f * std::sin(0.1f * static_cast<float>(column - row));
    }
  }
  const MeasuredMoments measured(y);
  ThreadPool pool(1);
  Dssim dssim;
  for (auto _ : state) benchmark::DoNotOptimize(dssim.evaluate(x, measured, gradient, pool));
}
BENCHMARK(DssimOfOneChannel)->Unit(benchmark::kMillisecond);

}  // namespace
