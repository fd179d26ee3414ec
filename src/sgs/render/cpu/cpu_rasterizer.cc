// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/cpu_rasterizer.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "sgs/render/cpu/frustum.h"
#include "sgs/render/cpu/project.h"
#include "sgs/render/cpu/splat_backward.h"
#include "sgs/render/evaluation_check.h"

namespace sgs::render::cpu {
namespace {

/// first_slot_ holds the end of the last Gaussian's slots too.
constexpr std::size_t kSlotStride = kChunk + 1;

template <class T>
void match_size(Image<T>& image, const TileGrid& grid) {
  if (image.width() != grid.width || image.height() != grid.height) {
    image = Image<T>(grid.width, grid.height);
  }
}

TileLoss tile_loss(const LossConfig& loss) {
  TileLoss out;
  out.color_weight = loss.color_weight / 3;
  out.color_knee = std::max(loss.color_knee, kLeastKnee);
  out.depth_knee_m = std::max(loss.depth_knee_m, kLeastKnee);
  out.depth_weight = loss.depth_weight;
  std::copy(loss.gain.begin(), loss.gain.end(), out.gain);
  out.floater_margin_m = loss.floater_margin_m;
  out.depth_relative = loss.depth_form == DepthForm::kAlphaRelative;
  out.color_only_where_depth = loss.color_only_where_depth;
  return out;
}

/// The Gaussians of chunk number `chunk` of `count` that are worth a look, into `indices`; returns
/// their number.
std::size_t list_chunk(std::size_t chunk, std::size_t count, const Frustum& frustum,
                       const ViewScope& scope, std::uint32_t* indices) {
  constexpr std::size_t kBlock = map::MeanBounds::kBlock;
  static_assert(kChunk % kBlock == 0 && map::GaussianSet::kWord == kBlock);
  const std::size_t first = chunk * kChunk, end = std::min<std::size_t>(first + kChunk, count);
  std::size_t listed = 0;
  for (std::size_t begin = first; begin < end; begin += kBlock) {
    const std::size_t block = begin / kBlock;
    std::uint64_t mask =
        scope.candidates == nullptr ? ~std::uint64_t{0} : scope.candidates->maybe(block);
    if (end - begin < kBlock) mask &= ~(~std::uint64_t{0} << (end - begin));
    if (mask == 0) continue;
    if (scope.bounds != nullptr && !frustum.may_show(scope.bounds->boxes()[block])) continue;
    if (mask == ~std::uint64_t{0}) {
      std::iota(indices + listed, indices + listed + kBlock, static_cast<std::uint32_t>(begin));
      listed += kBlock;
      continue;
    }
    for (; mask != 0; mask &= mask - 1) {
      indices[listed++] =
          static_cast<std::uint32_t>(begin) + static_cast<std::uint32_t>(std::countr_zero(mask));
    }
  }
  return listed;
}

}  // namespace

CpuRasterizer::CpuRasterizer(ThreadPool* pool)
    : own_pool_(1), pool_(pool != nullptr ? pool : &own_pool_) {
  scratch_.resize(static_cast<std::size_t>(pool_->threads()));
}

void CpuRasterizer::render(std::span<const map::Gaussian> gaussians, const PinholeCamera& camera,
                           const SE3& T_world_camera, Rendering& out) {
  SGS_CHECK(camera.valid(), "the camera must be valid");
  const TileGrid grid(camera.width, camera.height);
  arrange(gaussians, make_view<float>(camera, T_world_camera), grid, {});
  forward_only(grid, kMinTransmittance);
  store(grid, out);
}

std::shared_ptr<const TrainingView> CpuRasterizer::prepare(const TrainingImage& image) const {
  check_training_image(image);
  return std::make_shared<CpuTrainingView>(image);
}

void CpuRasterizer::evaluate(std::span<const map::Gaussian> gaussians, const TrainingView& training,
                             const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                             const EvaluateOptions& options) {
  const auto* own = dynamic_cast<const CpuTrainingView*>(&training);
  SGS_CHECK(own != nullptr, "the training view was prepared by another kind of rasterizer");
  const View<float> view = make_view<float>(training.camera(), T_world_camera);
  check_options(options, gaussians.size());
  arrange(gaussians, view, own->grid(), options.scope);
  out.loss = 0;
  has_color_gradient_ = loss.dssim_weight != 0.0f;
  if (has_color_gradient_) out.loss += add_dssim(*own, loss, options.scope.min_transmittance);
  visit_tiles(*own, loss, options);
  out.exposure_measured = out.exposure_rendered = {0, 0, 0};
  for (const TileResult& r : results_) {
    out.loss += r.loss;
    for (std::size_t c = 0; c < 3; ++c) {
      out.exposure_measured[c] += r.exposure_measured[c];
      out.exposure_rendered[c] += r.exposure_rendered[c];
    }
  }
  splat_backward(gaussians, view, out, options.sink);
  const Capture& capture = options.capture;
  if (capture.reached != nullptr) mark_reached(gaussians.size(), *capture.reached);
  if (capture.rendering != nullptr) store(own->grid(), *capture.rendering);
}

void CpuRasterizer::arrange(std::span<const map::Gaussian> gaussians, const View<float>& view,
                            const TileGrid& grid, const ViewScope& scope) {
  const std::size_t count = gaussians.size(), chunks = (count + kChunk - 1) / kChunk;
  SGS_CHECK(count < (std::size_t{1} << 31), "too many Gaussians");
  const std::size_t capacity = chunks * kChunk;
  records_.ensure(capacity);
  keys_.ensure(capacity);
  rects_.ensure(capacity);
  sources_.ensure(capacity);
  first_slot_.ensure(chunks * kSlotStride);
  visible_.resize(chunks);
  first_visible_.resize(chunks + 1);
  slot_base_.resize(chunks);
  const Frustum frustum(view);
  pool_->run(static_cast<int>(chunks), [&](int chunk, int) {
    const auto c = static_cast<std::size_t>(chunk), first = c * kChunk;
    std::array<std::uint32_t, kChunk> indices;
    const std::size_t listed = list_chunk(c, count, frustum, scope, indices.data());
    const ProjectedChunk to = {records_.data() + first, keys_.data() + first, rects_.data() + first,
                               sources_.data() + first, first_slot_.data() + c * kSlotStride};
    const ChunkCount found = project_chunk(view, gaussians.data(), {indices.data(), listed}, to);
    visible_[c] = found.visible;
    slot_base_[c] = found.slots;
  });
  std::uint32_t visible = 0;
  total_slots_ = 0;
  for (std::size_t c = 0; c < chunks; ++c) {
    first_visible_[c] = visible;
    visible += visible_[c];
    const std::uint32_t slots = slot_base_[c];
    slot_base_[c] = total_slots_;
    total_slots_ += slots;
  }
  first_visible_[chunks] = visible;
  lists_.build(visible_, keys_.data(), rects_.data(), grid.tiles_x, grid.tiles_y, *pool_);
}

TileJob CpuRasterizer::job_for(const TileGrid& grid, int tile, float min_transmittance) {
  TileJob job;
  job.records = records_.data();
  job.entries = lists_.tile(tile);
  job.tile_x = tile % grid.tiles_x;
  job.tile_y = tile / grid.tiles_x;
  job.width = grid.width;
  job.height = grid.height;
  job.min_transmittance = min_transmittance;
  return job;
}

void CpuRasterizer::forward_only(const TileGrid& grid, float min_transmittance) {
  image_.ensure(static_cast<std::size_t>(grid.tiles()) * tile_floats(kImageChannels));
  pool_->run(grid.tiles(), [&](int t, int worker) {
    TileJob job = job_for(grid, t, min_transmittance);
    job.image = image_.data() + static_cast<std::size_t>(t) * tile_floats(kImageChannels);
    process_tile(job, scratch_[static_cast<std::size_t>(worker)]);
  });
}

/// SSIM needs a pixel's neighbours across tile borders, hence a rendering of the whole image ahead
/// of the tile visits. (Compositing twice is cheaper than keeping the alphas of all tiles.)
double CpuRasterizer::add_dssim(const CpuTrainingView& training, const LossConfig& loss,
                                float min_transmittance) {
  const TileGrid& grid = training.grid();
  forward_only(grid, min_transmittance);
  color_gradient_.ensure(static_cast<std::size_t>(grid.tiles()) * tile_floats(kGradientChannels));
  if (plane_.width != grid.width || plane_.height != grid.height) {
    plane_ = PaddedPlane(grid.width, grid.height);
  }
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float gain = loss.gain[c], weight = loss.dssim_weight / 3 * gain;
    const std::size_t channel = c * kBlockPixels;
    pool_->run(grid.tiles_y, [&](int row, int) {
      for_each_run(grid, row, kImageChannels, [&](int x, int y, int n, std::size_t index) {
        const float* from = image_.data() + index + channel;
        float* to = plane_.row(y) + x;
        for (int i = 0; i < n; ++i) to[i] = gain * from[i];
        for (int i = 0; !training.all_seen() && i < n; ++i) {
          if (!training.seen(x + i, y)) to[i] = 0;
        }
      });
    });
    sum += dssim_.evaluate(plane_, training.moments()[c], plane_gradient_, *pool_);
    pool_->run(grid.tiles_y, [&](int row, int) {
      for_each_run(grid, row, kGradientChannels, [&](int x, int y, int n, std::size_t index) {
        const float* from = plane_gradient_.row(y) + x;
        float* to = color_gradient_.data() + index + channel;
        for (int i = 0; i < n; ++i) to[i] = weight * from[i];
      });
    });
  }
  return sum * static_cast<double>(loss.dssim_weight) / 3;
}

void CpuRasterizer::visit_tiles(const CpuTrainingView& training, const LossConfig& loss,
                                const EvaluateOptions& options) {
  const bool keep_image = options.capture.rendering != nullptr;
  const TileGrid& grid = training.grid();
  const TileLoss weights = tile_loss(loss);
  slots_.ensure(total_slots_ + kSlotsReadAhead);
  slot_used_.ensure(total_slots_);
  std::fill_n(slot_used_.data(), total_slots_, std::uint8_t{0});
  results_.resize(static_cast<std::size_t>(grid.tiles()));
  if (keep_image) {
    image_.ensure(static_cast<std::size_t>(grid.tiles()) * tile_floats(kImageChannels));
  }
  pool_->run(grid.tiles(), [&](int t, int worker) {
    const auto i = static_cast<std::size_t>(t);
    TileJob job = job_for(grid, t, options.scope.min_transmittance);
    if (keep_image) job.image = image_.data() + i * tile_floats(kImageChannels);
    job.training = training.tile(t);
    if (has_color_gradient_) {
      job.color_gradient = color_gradient_.data() + i * tile_floats(kGradientChannels);
    }
    job.loss = weights;
    job.slot_base = slot_base_.data();
    job.slots = slots_.data();
    job.slot_used = slot_used_.data();
    job.note_reached = options.capture.reached != nullptr;
    job.reached_weight = options.capture.reached_weight;
    job.result = &results_[i];
    process_tile(job, scratch_[static_cast<std::size_t>(worker)]);
  });
}

void CpuRasterizer::splat_backward(std::span<const map::Gaussian> gaussians,
                                   const View<float>& view, Gradients& out, GradientSink* sink) {
  constexpr std::uint32_t kRowsAtOnce = 128;  // 8 KiB, still in the first cache when the sink reads
  const std::size_t chunks = visible_.size(), visible = first_visible_[chunks];
  out.visible.resize(visible);
  out.gradient.resize(sink == nullptr ? visible : 0);
  twists_.resize(chunks);
  pool_->run(static_cast<int>(chunks), [&](int chunk, int) {
    const auto c = static_cast<std::size_t>(chunk);
    const std::uint32_t count = visible_[c];
    const std::span indices(out.visible.data() + first_visible_[c], count);
    std::copy_n(sources_.data() + c * kChunk, count, indices.data());
    twists_[c].fill(0);
    SplatBackwardJob job;
    job.gaussians = gaussians.data();
    job.slots = slots_.data() + slot_base_[c];
    job.slot_used = slot_used_.data() + slot_base_[c];
    job.twist = twists_[c].data();
    std::array<map::Gaussian, kRowsAtOnce> rows;
    for (std::uint32_t i = 0; i < count; i += kRowsAtOnce) {
      job.sources = indices.data() + i;
      job.first_slot = first_slot_.data() + c * kSlotStride + i;
      job.visible = std::min(kRowsAtOnce, count - i);
      job.gradient = sink == nullptr ? out.gradient.data() + first_visible_[c] + i : rows.data();
      splat_backward_chunk(view, job);
      if (sink != nullptr) sink->accept(indices.subspan(i, job.visible), rows.data());
    }
  });
  out.camera_twist.setZero();
  for (const auto& twist : twists_) {
    for (int k = 0; k < 6; ++k) out.camera_twist[k] += twist[static_cast<std::size_t>(k)];
  }
}

/// A Gaussian reached the image where it did so in one of its tiles.
void CpuRasterizer::mark_reached(std::size_t gaussians, map::GaussianSet& out) {
  out.clear(gaussians);
  pool_->run(static_cast<int>(visible_.size()), [&](int chunk, int) {
    const auto c = static_cast<std::size_t>(chunk);
    const std::uint32_t* sources = sources_.data() + c * kChunk;
    const std::uint32_t* first = first_slot_.data() + c * kSlotStride;
    const std::uint8_t* used = slot_used_.data() + slot_base_[c];
    for (std::uint32_t i = 0; i < visible_[c]; ++i) {
      const std::uint8_t* end = used + first[i + 1];
      if (std::find(used + first[i], end, kSlotReached) != end) out.insert(sources[i]);
    }
  });
}

void CpuRasterizer::store(const TileGrid& grid, Rendering& out) {
  match_size(out.color, grid);
  match_size(out.depth_sum, grid);
  match_size(out.alpha, grid);
  pool_->run(grid.tiles_y, [&](int row, int) {
    for_each_run(grid, row, kImageChannels, [&](int x, int y, int n, std::size_t index) {
      const float* from = image_.data() + index;
      Rgbf* color = out.color.row(y) + x;
      for (int i = 0; i < n; ++i) {
        color[i] = {from[i], from[i + kBlockPixels], from[i + 2 * kBlockPixels]};
      }
      std::copy_n(from + 3 * kBlockPixels, n, out.depth_sum.row(y) + x);
      std::copy_n(from + 4 * kBlockPixels, n, out.alpha.row(y) + x);
    });
  });
}

}  // namespace sgs::render::cpu

namespace sgs::render {

std::unique_ptr<Rasterizer> make_cpu_rasterizer(ThreadPool* pool) {
  return std::make_unique<cpu::CpuRasterizer>(pool);
}

}  // namespace sgs::render
