// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/mapper.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>

#include "sgs/core/log.h"
#include "sgs/map/gaussian_store.h"
#include "sgs/map/mean_bounds.h"
#include "sgs/mapper/colour_view.h"
#include "sgs/mapper/insertion.h"
#include "sgs/mapper/keyframe.h"
#include "sgs/mapper/keyframe_culling.h"
#include "sgs/mapper/keyframe_refinement.h"
#include "sgs/mapper/known_anchor.h"
#include "sgs/mapper/map_archive.h"
#include "sgs/mapper/merge_layers.h"
#include "sgs/mapper/move_map.h"
#include "sgs/mapper/optimizer.h"
#include "sgs/mapper/schedule.h"
#include "sgs/mapper/snapshot_pool.h"
#include "sgs/mapper/trainer.h"
#include "sgs/mapper/view_candidates.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {
namespace {

bool has_depth(const RgbdFrame& frame, double max_depth_m) {
  constexpr std::size_t kMinShare = 200;  // one pixel in so many
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const float z = frame.depth.data()[i];
    count += z > 0 && z <= static_cast<float>(max_depth_m) ? 1 : 0;
  }
  return count > 0 && count * kMinShare >= frame.depth.size();
}

}  // namespace

struct Mapper::Impl {
  Impl(const MapperConfig& c, const PinholeCamera& cam, std::uint64_t seed, ThreadPool* pool,
       std::shared_ptr<history::ViewStore> store_of_views)
      : config(for_focal_length(c, 0.5 * (cam.fx + cam.fy))),
        camera(cam),
        rasterizer(render::make_cpu_rasterizer(pool)),
        training_views(*rasterizer, static_cast<std::size_t>(c.schedule.full_views_kept)),
        optimizer(c.optimizer),
        schedule(seed, c.schedule.order, c.schedule.visit_bias),
        views(c.schedule.look_interval),
        trainer(c.objective, c.refinement),
        kept(store_of_views ? std::move(store_of_views)
                            : std::make_shared<history::ViewStore>(history::HistoryConfig{},
                                                                   c.insertion.max_depth_m)) {}

  void step();
  void prune();
  /// After a move only: what keyframes see is forgotten then, and need not follow the removal.
  void merge_layers(std::span<const SE3> moves);
  void cull_keyframes();
  void cull(std::size_t index);
  KeyframeView remember(const RgbdFrame& frame, const Vector6d& lag);
  KeyframeView coloured(const KnownKeyframe& view);
  void make_room();
  void take_awaited();
  /// Everything but the keyframes.
  template <class Archive>
  void archive(Archive& a) {
    a(store, schedule, views, iterations, trainer, version);
  }
  bool consistent() const;

  MapperConfig config;
  PinholeCamera camera;
  std::unique_ptr<render::Rasterizer> rasterizer;
  TrainingViewCache training_views;
  Optimizer optimizer;
  Schedule schedule;
  ViewCandidates views;
  map::GaussianSet removed;
  Trainer trainer;
  map::GaussianStore store;
  map::MeanBounds bounds;                    // of store.raw and store.average
  std::shared_ptr<history::ViewStore> kept;  // what keyframes show
  history::CalibrationPtr calibration;       // of their depth
  std::vector<MapKeyframe> keyframes;
  std::deque<MapKeyframe> awaited;  // restored keyframes without pictures, in order
  render::Rendering rendering;
  std::int64_t iterations = 0;
  bool changed = true;
  std::uint64_t version = 0;
  map::SnapshotPtr newest;
  SnapshotPool snapshots;
  StageTimes times{"mapping"};
};

void Mapper::Impl::step() {
  const ScopedTimer timer(times, "map/iteration");
  const std::size_t index = schedule.next();
  MapKeyframe& keyframe = keyframes[index];
  const int level = schedule.random().uniform() < config.schedule.half_resolution_share ? 1 : 0;
  trainer.begin(keyframe, level);
  const double asked_s = wall_time_s();
  const auto training = training_views.get(keyframe, index, level);
  times.add_interval("map/iteration/view", asked_s, 1e3 * (wall_time_s() - asked_s));
  if (!training) return cull(index);
  StepWithBackward step_with_backward(optimizer, store, bounds);
  const ViewCandidates::Visit visit = views.next(index, store.size());
  const render::EvaluateOptions options = {
      .scope = {.bounds = &bounds,
                .candidates = visit.candidates,
                .min_transmittance = static_cast<float>(config.schedule.min_transmittance)},
      .capture = {.reached = visit.reached,
                  .reached_weight = static_cast<float>(config.schedule.min_weight)},
      .sink = &step_with_backward};
  trainer.evaluate(*rasterizer, store.raw, keyframe, *training, options);
  if (index > 0) {  // the first one fixes the map's exposure and its place in the world
    trainer.learn_exposure(keyframe);
    if (!trainer.learn_pose(keyframe)) return cull(index);
  }
  ++keyframe.visits;
  ++iterations;
  changed = true;
  if (iterations % config.schedule.prune_interval == 0) prune();
}

void Mapper::Impl::prune() {
  const ScopedTimer timer(times, "map/prune");
  const double opacity = config.schedule.prune_opacity;
  const auto min_logit = static_cast<float>(std::log(opacity / (1 - opacity)));
  const auto max_log_scale = static_cast<float>(std::log(config.schedule.prune_scale_m));
  removed.clear(store.size());
  const auto is_useless = [&](std::size_t i) {
    const map::Gaussian& g = store.raw[i];
    const float largest = std::max({g.log_scale[0], g.log_scale[1], g.log_scale[2]});
    // Written so that NaN goes, too.
    return !(g.opacity_logit >= min_logit) || !(largest <= max_log_scale) ||
           !std::isfinite(g.mean[0] + g.mean[1] + g.mean[2]);
  };
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (is_useless(i)) removed.insert(i);
  }
  views.follow_removal(removed);
  store.remove_if([this](std::size_t i) { return removed.contains(i); });
  bounds.assign(store.raw, store.average);
}

void Mapper::Impl::merge_layers(std::span<const SE3> moves) {
  const ScopedTimer timer(times, "map/merge");
  const std::size_t merged = mapper::merge_layers(moves, config.merge, store, removed);
  if (merged == 0) return;
  log().debug("{} of {} Gaussians were there twice", merged, store.size());
  store.remove_if([this](std::size_t i) { return removed.contains(i); });
}

void Mapper::Impl::cull_keyframes() {
  while (schedule.active().size() > static_cast<std::size_t>(config.schedule.most_keyframes)) {
    cull(most_redundant(keyframes, schedule.active()));
  }
}

// Of the last one nothing can be learned any more either, where its view is gone; but there is
// nothing else.
void Mapper::Impl::cull(std::size_t index) {
  if (schedule.active().size() < 2) return;
  schedule.cull(index);
  keyframes[index].cull();
  training_views.forget(index);
  views.forget(index);
}

KeyframeView Mapper::Impl::remember(const RgbdFrame& frame, const Vector6d& lag) {
  return {kept->keep(frame, calibration), config.insertion.max_depth_m, calibration, lag};
}

// One that is gone already stays so.
KeyframeView Mapper::Impl::coloured(const KnownKeyframe& view) {
  auto frame = view.view->frame(calibration);
  auto kept_view = view.view;
  if (frame) {
    rasterizer->render(store.average, camera, view.T_world_camera, rendering);
    colour_view(rendering, *frame);
    kept_view = kept->keep_changed(*frame, calibration);
  }
  return {kept_view, config.insertion.max_depth_m, calibration, view.lag};
}

// Few steps need the pictures, as most work at half resolution; half-resolution views go after
// them.
void Mapper::Impl::make_room() {
  kept->note_beside(training_views.half_bytes(keyframes) + views.bytes());
  training_views.drop_halves(kept->excess_bytes(), keyframes);
}

Mapper::Mapper(const MapperConfig& config, const PinholeCamera& camera, std::uint64_t seed,
               ThreadPool* pool, std::shared_ptr<history::ViewStore> views)
    : impl_(std::make_unique<Impl>(config, camera, seed, pool, std::move(views))) {}

Mapper::~Mapper() = default;

int Mapper::add_keyframe(const std::shared_ptr<const RgbdFrame>& frame, const SE3& T) {
  return add_keyframe(frame, T, T);
}

int Mapper::add_keyframe(const std::shared_ptr<const RgbdFrame>& frame, const SE3& T,
                         const SE3& T_odom_camera, const Vector6d& lag) {
  Impl& m = *impl_;
  SGS_CHECK(frame && frame->camera == m.camera, "the keyframe's camera differs from the mapper's");
  const bool finite = T.all_finite() && T_odom_camera.all_finite();
  if (!finite || !has_depth(*frame, m.config.insertion.max_depth_m)) {
    log().warn("frame {} is not used for mapping: {}", frame->index,
               finite ? "it has hardly any depth" : "its pose is not finite");
    return -1;
  }
  const ScopedTimer timer(m.times, "map/insertion");
  const auto index = static_cast<int>(m.keyframes.size());
  const KeyframeView view = m.remember(*frame, lag);
  const auto held = view.kept->pictures();  // and not read anew by each step of the insertion
  {
    const ScopedTimer part(m.times, "map/insertion/keyframe");
    m.keyframes.emplace_back(view, T);
  }
  MapKeyframe& keyframe = m.keyframes.back();
  keyframe.T_odom_camera = T_odom_camera;
  // Rarely more than one new Gaussian for every 4x4 pixels.
  reserve(m.store,
          m.store.size() + static_cast<std::size_t>(m.camera.width * m.camera.height / 16));
  if (m.config.insertion.method == InsertionMethod::kGrid) {
    insert_grid(keyframe, index, m.config.insertion, m.store);
  } else {
    const bool empty = m.store.size() == 0;
    if (!empty) {
      const ScopedTimer part(m.times, "map/insertion/render");
      m.rasterizer->render(m.store.average, m.camera.halved(m.config.insertion.rendering_level), T,
                           m.rendering);
      if (m.config.refinement.exposure) {
        keyframe.gain = m.keyframes[m.keyframes.size() - 2].gain;
        const ExposureSums sums = exposure_sums(keyframe, m.rendering);
        update_gain(keyframe, sums.measured, sums.rendered, m.config.refinement.exposure_prior, 1);
      }
    }
    const ScopedTimer part(m.times, "map/insertion/gaussians");
    insert_quadtree(keyframe, index, empty ? nullptr : &m.rendering, m.config.insertion,
                    m.config.optimizer.max_growth, m.store);
  }
  m.bounds.append(m.store.raw);
  m.schedule.add_keyframe(static_cast<std::size_t>(index));
  {
    const ScopedTimer part(m.times, "map/insertion/memory");
    m.cull_keyframes();
    m.make_room();
  }
  m.changed = true;
  if (index == 0) iterate(m.config.first_keyframe_iterations);
  return index;
}

void Mapper::know(const std::vector<map::Gaussian>& gaussians,
                  const std::vector<std::int32_t>& view_of,
                  const std::vector<KnownKeyframe>& views) {
  constexpr std::uint32_t kSteps = 1024;  // like one that has been learned for long
  constexpr std::size_t kVisits = 12;     // of a keyframe, where keyframes and steps are as usual
  const float growth = std::log(2.0f);
  Impl& m = *impl_;
  SGS_CHECK(m.keyframes.empty() && m.awaited.empty() && m.store.size() == 0, "a new mapper");
  SGS_CHECK(view_of.size() == gaussians.size() && !views.empty(), "each Gaussian has its view");
  const ScopedTimer timer(m.times, "map/know");
  reserve(m.store, gaussians.size());
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    const map::Gaussian& g = gaussians[i];
    const KnownKeyframe& view = views.at(static_cast<std::size_t>(view_of[i]));
    m.store.append(g, known_anchor(g, view_of[i], view.T_world_camera),
                   *std::max_element(g.log_scale, g.log_scale + 3) + growth);
    m.store.steps.back() = kSteps;
  }
  m.bounds.assign(m.store.raw, m.store.average);
  for (const KnownKeyframe& view : views) {
    SGS_CHECK(view.view->camera() == m.camera, "the view's camera differs from the mapper's");
    const std::size_t index = m.keyframes.size();
    const KeyframeView shown = m.coloured(view);
    const auto held = shown.kept->pictures();
    MapKeyframe& keyframe = m.keyframes.emplace_back(shown, view.T_world_camera);
    keyframe.T_odom_camera = view.T_odom_camera;
    if (m.config.refinement.exposure && index > 0) {
      const ExposureSums sums = exposure_sums(keyframe, m.rendering);
      update_gain(keyframe, sums.measured, sums.rendered, m.config.refinement.exposure_prior, 1);
    }
    m.schedule.add_keyframe(index);
    m.cull_keyframes();
    m.make_room();
  }
  // They have had their turns, as often as the map was learned from a keyframe: new ones come
  // first.
  for (std::size_t k = 0; k < kVisits * views.size(); ++k) (void)m.schedule.next();
  m.changed = true;
}

void Mapper::move_keyframes(const std::vector<SE3>& moves) {
  Impl& m = *impl_;
  SGS_CHECK(moves.size() == m.keyframes.size(), "a move for every keyframe");
  const ScopedTimer timer(m.times, "map/move");
  for (std::size_t k = 0; k < moves.size(); ++k) {
    MapKeyframe& keyframe = m.keyframes[k];
    keyframe.T_world_camera = (moves[k] * keyframe.T_world_camera).normalized();
    keyframe.T_odom_camera = (moves[k] * keyframe.T_odom_camera).normalized();
  }
  move_gaussians(moves, m.store);
  if (m.config.merge.enabled) m.merge_layers(moves);
  m.bounds.assign(m.store.raw, m.store.average);
  m.views.forget();
  m.changed = true;
}

void Mapper::change_depth(const history::CalibrationPtr& calibration) {
  Impl& m = *impl_;
  const auto change = history::depth_change(m.calibration, calibration);
  SGS_CHECK(change != nullptr, "change_depth() needs a change");
  m.calibration = calibration;
  const ScopedTimer timer(m.times, "map/change depth");
  std::vector<SE3> T_world_keyframe;
  for (MapKeyframe& keyframe : m.keyframes) {
    keyframe.see_with(calibration);
    keyframe.pose_information.reset();
    T_world_keyframe.push_back(keyframe.T_world_camera);
  }
  mapper::change_depth(T_world_keyframe, *change, m.store);
  m.training_views.forget();
  m.bounds.assign(m.store.raw, m.store.average);
  m.views.forget();
  m.changed = true;
}

IterationReport Mapper::iterate(int count) {
  Impl& m = *impl_;
  if (m.keyframes.empty()) return {};
  for (int i = 0; i < count; ++i) m.step();
  return {count, m.trainer.last_loss()};
}

void Mapper::save(ArchiveWriter& archive) {
  Impl& m = *impl_;
  SGS_CHECK(m.awaited.empty(), "a mapper is saved once it is restored");
  const ScopedTimer timer(m.times, "map/save");
  constexpr std::size_t kBytesPerGaussian = 2 * sizeof(map::Gaussian) + sizeof(map::Moments) + 48;
  archive.reserve(m.store.size() * kBytesPerGaussian + m.views.bytes() + (1 << 20));
  std::uint64_t count = m.keyframes.size();
  archive(count);
  for (MapKeyframe& keyframe : m.keyframes) archive(keyframe);
  archive(m);
}

// What a file says is believed only where nothing can go out of bounds by it.
bool Mapper::Impl::consistent() const {
  for (std::size_t k = 0; k < awaited.size(); ++k) {
    if (awaited[k].visits < 0 || !(awaited[k].mean_depth_m() > 0)) return false;
    if (k > 0 && awaited[k].frame_index() <= awaited[k - 1].frame_index()) return false;
  }
  const auto known = [this](const map::Anchor& anchor) {
    return anchor.keyframe >= -1 && anchor.keyframe < static_cast<std::int64_t>(awaited.size());
  };
  for (std::size_t k = 0; k < awaited.size(); ++k) {
    const bool active = std::binary_search(schedule.active().begin(), schedule.active().end(), k);
    if (awaited[k].culled() == active) return false;
  }
  return map::consistent(store) && std::all_of(store.anchors.begin(), store.anchors.end(), known) &&
         schedule.consistent() && schedule.keyframes() == awaited.size() &&
         views.consistent(awaited.size(), store.size()) && iterations >= 0 && trainer.consistent();
}

Status Mapper::restore(ArchiveReader& archive) {
  Impl& m = *impl_;
  SGS_CHECK(m.keyframes.empty() && m.awaited.empty(), "a mapper that is restored must be new");
  std::uint64_t count = 0;
  archive(count);
  for (std::uint64_t i = 0; i < count && !archive.failed(); ++i) {
    archive(m.awaited.emplace_back(m.camera));
  }
  archive(m);
  if (archive.failed() || !m.consistent()) {
    return fail(ErrorCode::kInvalidFormat, "the state of the map makes no sense");
  }
  m.bounds.assign(m.store.raw, m.store.average);
  m.take_awaited();
  return {};
}

// Those that are not learned from need no pictures.
void Mapper::Impl::take_awaited() {
  while (!awaited.empty() && awaited.front().culled()) {
    keyframes.push_back(std::move(awaited.front()));
    awaited.pop_front();
  }
}

std::optional<std::int64_t> Mapper::awaited_frame() const {
  if (impl_->awaited.empty()) return std::nullopt;
  return impl_->awaited.front().frame_index();
}

void Mapper::restore_keyframe(const RgbdFrame& frame, const Vector6d& lag) {
  Impl& m = *impl_;
  SGS_CHECK(frame.index == awaited_frame(), "another frame is awaited");
  SGS_CHECK(frame.camera == m.camera, "the keyframe's camera differs from the mapper's");
  m.awaited.front().take_view(m.remember(frame, lag));
  m.keyframes.push_back(std::move(m.awaited.front()));
  m.awaited.pop_front();
  m.take_awaited();
  m.make_room();
}

void Mapper::restore_calibration(const history::CalibrationPtr& calibration) {
  impl_->calibration = calibration;
  for (MapKeyframe& keyframe : impl_->keyframes) keyframe.see_with(calibration);
}

map::SnapshotPtr Mapper::snapshot() {
  Impl& m = *impl_;
  if (m.changed || !m.newest) {
    const ScopedTimer timer(m.times, "map/snapshot");
    auto snapshot = m.snapshots.take(m.store.size());
    snapshot->version = ++m.version;
    snapshot->gaussians = m.config.optimizer.average > 0 ? m.store.average : m.store.raw;
    snapshot->anchors = m.store.anchors;
    snapshot->T_world_keyframe.clear();
    snapshot->keyframe_frames.clear();
    for (const MapKeyframe& keyframe : m.keyframes) {
      snapshot->T_world_keyframe.push_back(keyframe.T_world_camera);
      snapshot->keyframe_frames.push_back(keyframe.frame_index());
    }
    m.newest = std::move(snapshot);
    m.changed = false;
  }
  return m.newest;
}

std::size_t Mapper::size() const { return impl_->store.size(); }
std::int64_t Mapper::iterations() const { return impl_->iterations; }
const StageTimes& Mapper::times() const { return impl_->times; }

}  // namespace sgs::mapper
