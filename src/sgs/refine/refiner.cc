// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/refiner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sgs/core/stopwatch.h"
#include "sgs/mapper/balanced_order.h"
#include "sgs/mapper/insertion.h"
#include "sgs/mapper/keyframe_refinement.h"
#include "sgs/mapper/optimizer.h"
#include "sgs/mapper/trainer.h"
#include "sgs/refine/densify.h"
#include "sgs/refine/heldout_judge.h"
#include "sgs/refine/learned_harmonics.h"
#include "sgs/refine/learning_sink.h"
#include "sgs/refine/shutter.h"

namespace sgs::refine {
namespace {

/// Share of the rates at the beginning: Adam knows nothing of a Gaussian's gradients yet, and goes
/// the whole rate after whatever the first picture says. It ends after `config.warmup_steps` or a
/// tenth of the budget, whichever is first.
double warmth(const RefineConfig& config, std::int64_t steps, double share) {
  constexpr double kMostShare = 0.1;  // of the budget
  if (steps >= config.warmup_steps) return 1;
  return std::min(
      1.0, std::max(static_cast<double>(steps + 1) / config.warmup_steps, share / kMostShare));
}

/// The optimiser's settings after `steps`, when `share` of the budget is spent: rates rise first,
/// and then fall exponentially.
mapper::OptimizerConfig rates_at(const RefineConfig& config, std::int64_t steps, double share) {
  const double left = std::pow(config.rate_end, share) * warmth(config, steps, share);
  mapper::OptimizerConfig rates = config.optimizer;
  for (double* rate : {&rates.rate_mean_m, &rates.rate_log_scale, &rates.rate_rotation,
                       &rates.rate_opacity, &rates.rate_color}) {
    *rate *= left;
  }
  return rates;
}

/// Whether learning still gets anywhere: some checks in a row without a state better than all that
/// were learnt before end it. The map that it began with does not count: what is learnt may have to
/// climb past it from below, and does, as long as it rises.
class EarlyStop {
 public:
  /// `checks`: so many in a row; 0 = without end.
  explicit EarlyStop(int checks) : checks_(checks) {}
  bool ends(double psnr_db) {
    without_gain_ = psnr_db > best_db_ ? 0 : without_gain_ + 1;
    best_db_ = std::max(best_db_, psnr_db);
    return checks_ > 0 && without_gain_ >= checks_;
  }

 private:
  int checks_, without_gain_ = 0;
  double best_db_ = -std::numeric_limits<double>::infinity();
};

/// A few of many, spread evenly.
std::vector<RefineFrame> spread(const std::vector<RefineFrame>& frames, std::size_t count) {
  if (frames.size() <= count) return frames;
  std::vector<RefineFrame> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(frames[(2 * i + 1) * frames.size() / (2 * count)]);
  }
  return chosen;
}

/// What a map has of harmonics is kept; those of a higher degree start at zero.
map::Harmonics with_degree(const map::Harmonics& harmonics, int degree, std::size_t count) {
  if (degree <= harmonics.degree) return harmonics;
  map::Harmonics more{degree, {}};
  more.resize(count);
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    std::ranges::copy(harmonics.of(i), more.of(i).begin());
  }
  return more;
}

std::size_t full_views_within(const PinholeCamera& camera, std::size_t bytes) {
  constexpr std::size_t kBytesPerPixel = 4 * sizeof(float);
  const std::size_t pixels =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  return std::max<std::size_t>(1, bytes / (kBytesPerPixel * pixels));
}

}  // namespace

struct Refiner::Impl {
  Impl(const RefineConfig& c, std::uint64_t seed, std::vector<RefineFrame> training,
       std::vector<RefineFrame> heldout, const map::SplatMap& map, ThreadPool* threads)
      : config(c),
        frames(std::move(training)),
        judged_by_heldout(!heldout.empty()),
        judge(judged_by_heldout ? std::move(heldout) : spread(frames, kJudgesFromTraining),
              threads),
        rasterizer(render::make_cpu_rasterizer(threads)),
        views(*rasterizer, full_views_within(frames.front().keyframe.camera(),
                                             (static_cast<std::size_t>(c.memory_mb) << 20) / 4)),
        optimizer(rates_at(c, 0, 0)),
        random(seed),
        trainer(c.objective, c.keyframes),
        harmonics(with_degree(map.harmonics, c.harmonics, map.gaussians.size())),
        colors(threads),
        pool(threads) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      all.push_back(i);
      order.add(frames[i].weight, random);
    }
    const double growth = c.optimizer.max_growth;
    for (const map::Gaussian& g : map.gaussians) {
      const float largest = std::max({g.log_scale[0], g.log_scale[1], g.log_scale[2]});
      store.append(g, {}, mapper::longest_log_scale(largest, growth));
    }
    harmonics.resize(store.size());
    notes.begin(store.size());
    bounds.assign(store.raw, store.average);
  }

  static constexpr std::size_t kJudgesFromTraining = 24;

  void draw(const mapper::MapKeyframe& keyframe, int level);
  void fit_exposures();
  void fill_holes();
  void set_rates(double share);
  void step();
  void densify(double share);
  PoseCorrection correction() const;
  ExposureCurve exposures() const;
  Evaluation check(double share);

  RefineConfig config;
  std::vector<RefineFrame> frames;
  bool judged_by_heldout;
  HeldoutJudge judge;
  std::unique_ptr<render::Rasterizer> rasterizer;
  mapper::TrainingViewCache views;
  mapper::Optimizer optimizer;
  SplitMix64 random;
  mapper::BalancedOrder order;
  std::vector<std::size_t> all;  // frames
  mapper::Trainer trainer;
  LearnedHarmonics harmonics;
  render::ViewColors colors;
  map::GaussianStore store;
  map::MeanBounds bounds;
  GaussianNotes notes;
  render::Rendering rendering;
  std::vector<map::Gaussian> shifted;  // scratch
  ThreadPool* pool;
  std::int64_t steps = 0;
  std::size_t first_count = 0;  // Gaussians when splitting begins
  Refined result;
};

/// The map as a frame sees it, halved `level` times, into `rendering`.
void Refiner::Impl::draw(const mapper::MapKeyframe& keyframe, int level) {
  const SE3& T = keyframe.T_world_camera;
  harmonics.resize(store.size());
  rasterizer->render(colors.seen(store.average, harmonics.values(), T.t),
                     keyframe.camera().halved(level), T, rendering);
}

/// Gains from how bright the map is in each frame: the run does not keep them.
void Refiner::Impl::fit_exposures() {
  for (RefineFrame& frame : frames) {
    mapper::MapKeyframe& keyframe = frame.keyframe;
    draw(keyframe, 1);
    const auto sums = mapper::exposure_sums(keyframe, rendering);
    mapper::update_gain(keyframe, sums.measured, sums.rendered, config.keyframes.exposure_prior, 1);
  }
}

/// New Gaussians where the map is open or lies behind what was measured.
void Refiner::Impl::fill_holes() {
  const mapper::InsertionConfig insertion;
  const auto count = std::min(frames.size(), static_cast<std::size_t>(config.hole_views));
  for (std::size_t k = 0; k < count; ++k) {
    const mapper::MapKeyframe& keyframe =
        frames[(2 * k + 1) * frames.size() / (2 * count)].keyframe;
    draw(keyframe, insertion.rendering_level);
    mapper::insert_quadtree(keyframe, static_cast<int>(k), &rendering, insertion,
                            config.optimizer.max_growth, store);
  }
  harmonics.resize(store.size());
  notes.begin(store.size());
  bounds.assign(store.raw, store.average);
}

void Refiner::Impl::set_rates(double share) {
  const mapper::OptimizerConfig rates = rates_at(config, steps, share);
  optimizer.set_rates(rates);
  harmonics.set_rate(config.rate_harmonics * rates.rate_color);
}

/// The pull of all gains to 1 fixes the brightness of the map, and the first pose its place. Of a
/// frame whose pictures are gone nothing is learnt.
void Refiner::Impl::step() {
  const std::size_t index = order.next(all, random);
  RefineFrame& frame = frames[index];
  mapper::MapKeyframe& keyframe = frame.keyframe;
  ++steps;
  const auto training = views.get(keyframe, index, 0);
  if (!training) return;
  trainer.begin(keyframe, 0);
  const PinholeCamera& view = training->camera();
  LearningSink sink(optimizer, store, bounds, notes, harmonics, view, keyframe.T_world_camera,
                    config.least_sigma_px);
  render::EvaluateOptions options;
  options.scope.bounds = &bounds;
  options.scope.min_transmittance = 2e-3f;
  options.sink = &sink;
  std::span<const map::Gaussian> seen = store.raw;
  if (!frame.readout.isZero(0)) {
    shift_by_shutter(store.raw, view, keyframe.T_world_camera, frame.readout, shifted, pool);
    seen = shifted;
    options.scope.bounds = nullptr;  // they bound the Gaussians where they really are
  }
  seen = colors.seen(seen, harmonics.values(), keyframe.T_world_camera.t);
  trainer.evaluate(*rasterizer, seen, keyframe, *training, options);
  trainer.learn_exposure(keyframe);
  if (index > 0) (void)trainer.learn_pose(keyframe);
  ++keyframe.visits;
}

void Refiner::Impl::densify(double share) {
  remove_useless(config.densify.prune_opacity, store, notes, harmonics);
  const auto limit = static_cast<std::size_t>(config.max_gaussians);
  if (share >= config.densify.from && share < config.densify.until && store.size() < limit) {
    if (first_count == 0) first_count = store.size();
    const double way = (share - config.densify.from) / (config.densify.until - config.densify.from);
    const double grown = static_cast<double>(first_count) *
                         std::pow(static_cast<double>(limit) / static_cast<double>(first_count),
                                  std::min(1.0, 1.25 * way));
    const auto wanted = static_cast<std::size_t>(std::min(grown, static_cast<double>(limit)));
    const auto most = static_cast<std::size_t>(
        std::ceil(config.densify.split_share * static_cast<double>(store.size())));
    constexpr double kLeastSigma_px = 0.6;  // what is smaller does not split
    if (wanted > store.size()) {
      split_most_pulled(std::min(most, wanted - store.size()), kLeastSigma_px, store, notes,
                        harmonics);
    }
  }
  notes.fade();
  notes.begin(store.size());
  bounds.assign(store.raw, store.average);
}

PoseCorrection Refiner::Impl::correction() const {
  std::vector<MovedPose> moved;
  for (const RefineFrame& frame : frames) {
    moved.push_back(
        {frame.timestamp_s, frame.keyframe.T_odom_camera, frame.keyframe.T_world_camera});
  }
  return PoseCorrection(std::move(moved));
}

ExposureCurve Refiner::Impl::exposures() const {
  std::vector<Exposure> known;
  for (const RefineFrame& frame : frames) {
    known.push_back({frame.timestamp_s, frame.keyframe.gain});
  }
  return ExposureCurve(std::move(known));
}

Evaluation Refiner::Impl::check(double share) {
  Evaluation now;
  now.steps = steps;
  now.share = share;
  now.gaussians = store.size();
  now.heldout = judged_by_heldout;
  const PoseCorrection moved = judged_by_heldout ? correction() : PoseCorrection();
  const HeldoutScores scores = judge.scores(store.average, harmonics.values(), moved, exposures());
  now.psnr_db = scores.psnr_db;
  now.psnr_exposed_db = scores.psnr_exposed_db;
  now.best = result.gaussians.empty() || now.psnr_db > result.best.psnr_db;
  if (now.best) {
    result.gaussians = store.average;
    result.harmonics = harmonics.values();
    result.correction = correction();
    result.exposures = steps > 0 && config.keyframes.exposure ? exposures() : ExposureCurve();
    result.best = now;
  }
  result.last = now;
  return now;
}

Refiner::Refiner(const RefineConfig& config, std::uint64_t seed, std::vector<RefineFrame> training,
                 std::vector<RefineFrame> heldout, const map::SplatMap& map, ThreadPool* pool) {
  SGS_CHECK(!training.empty(), "refinement needs at least one frame");
  impl_ = std::make_unique<Impl>(config, seed, std::move(training), std::move(heldout), map, pool);
}

Refiner::~Refiner() = default;

const std::vector<map::Gaussian>& Refiner::best_gaussians() const {
  return impl_->result.gaussians;
}
const map::Harmonics& Refiner::best_harmonics() const { return impl_->result.harmonics; }
const PoseCorrection& Refiner::best_correction() const { return impl_->result.correction; }
const ExposureCurve& Refiner::best_exposures() const { return impl_->result.exposures; }

Refined Refiner::run(const Budget& budget, const Watch& watch, const std::stop_token& stop) {
  Impl& m = *impl_;
  const double begin_s = wall_time_s();
  const auto spent = [&] {
    if (budget.steps > 0) {
      return static_cast<double>(m.steps) / static_cast<double>(budget.steps);
    }
    return budget.seconds > 0 ? (wall_time_s() - begin_s) / budget.seconds : 1.0;
  };
  const auto look = [&](double share) {
    const Evaluation now = m.check(share);
    if (watch) watch(now);
  };
  m.result.heldout = m.judged_by_heldout;
  look(0);
  m.result.start = m.result.best;
  double share = spent();
  if (share < 1) {
    if (m.config.keyframes.exposure) m.fit_exposures();
    m.fill_holes();
  }
  EarlyStop early_stop(m.config.patience);
  int checks = 1;
  while ((share = spent()) < 1 && !stop.stop_requested()) {
    constexpr int kRatesFor = 50;  // steps
    if (m.steps % kRatesFor == 0 || m.steps <= m.config.warmup_steps) m.set_rates(share);
    m.step();
    if (m.steps % m.config.densify.interval == 0) m.densify(share);
    if (share * m.config.checks < checks) continue;
    checks = static_cast<int>(share * m.config.checks) + 1;
    look(share);
    m.result.exhausted = early_stop.ends(m.result.last.psnr_db);
    if (m.result.exhausted) break;
  }
  if (m.steps > m.result.last.steps) look(std::min(share, 1.0));
  m.result.stopped = stop.stop_requested();
  return std::move(m.result);
}

}  // namespace sgs::refine
