// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "sgs/render/cpu/buffer.h"
#include "sgs/render/cpu/layout.h"
#include "sgs/render/cpu/project.h"
#include "sgs/render/cpu/sort_bin.h"
#include "sgs/render/cpu/target.h"
#include "sgs/render/cpu/tile.h"
#include "sgs/render/rasterizer.h"
#include "sgs/render/view.h"

namespace sgs::render::cpu {

/// The stages of docs/rasterizer.md in order: project, sort, bin, tiles (forward, loss, backward),
/// then per-Gaussian backward. Every parallel loop writes to places fixed by its chunk, and sums
/// over chunks are taken in chunk order: the result does not depend on the number of threads.
class CpuRasterizer final : public Rasterizer {
 public:
  using Rasterizer::evaluate;

  /// `pool` may be null.
  explicit CpuRasterizer(ThreadPool* pool);

  std::string name() const override { return "cpu"; }
  void render(std::span<const map::Gaussian> gaussians, const PinholeCamera& camera,
              const SE3& T_world_camera, Rendering& out) override;
  std::shared_ptr<const PreparedTarget> prepare(const TrainingImage& image) const override;
  void evaluate(std::span<const map::Gaussian> gaussians, const PreparedTarget& target,
                const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                const EvaluateOptions& options) override;

 private:
  /// Projection, sorting and binning.
  void arrange(std::span<const map::Gaussian> gaussians, const View<float>& view,
               const TileGrid& grid, const EvaluateOptions& options);
  void forward_only(const TileGrid& grid, float min_transmittance);
  TileJob job_for(const TileGrid& grid, int tile, float min_transmittance);
  double add_dssim(const CpuTarget& target, const LossConfig& loss, float min_transmittance);
  void visit_tiles(const CpuTarget& target, const LossConfig& loss, const EvaluateOptions& options);
  void splat_backward(std::span<const map::Gaussian> gaussians, const View<float>& view,
                      Gradients& out, GradientSink* sink);
  void mark_reached(std::size_t gaussians, map::GaussianSet& out);
  void store(const TileGrid& grid, Rendering& out);

  ThreadPool own_pool_;
  ThreadPool* pool_;

  // Per chunk of Gaussians.
  std::vector<std::uint32_t> visible_, trained_, first_trained_, slot_base_;
  Buffer<Record> records_;
  Buffer<std::uint32_t> keys_, trained_sources_, first_slot_;
  Buffer<TileRect> rects_;
  std::vector<std::array<double, 6>> twists_;
  std::uint32_t total_slots_ = 0;

  TileLists lists_;
  Buffer<SumRow> slots_;
  Buffer<std::uint8_t> slot_used_;

  // Per tile and per thread.
  std::vector<TileResult> results_;
  std::vector<TileScratch> scratch_;
  Buffer<float> image_;

  bool has_color_gradient_ = false;
  Buffer<float> color_gradient_;
  Dssim dssim_;
  PaddedPlane plane_, plane_gradient_;
};

}  // namespace sgs::render::cpu
