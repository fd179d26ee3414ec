// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/joint_aligner.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <tuple>
#include <utility>

#include "sgs/alignment/loss_checks.h"
#include "sgs/degeneracy/planarity.h"

namespace sgs::alignment {
namespace {

degeneracy::NormalEquations normal_equations(const registration::Linearization& l) {
  return {l.H, l.b, 0.5 * l.error};
}

/// -H^-1 b, shortened to the caps; zero when there is no finite solution.
Vector6d capped_step(const degeneracy::NormalEquations& system,
                     const registration::SolverConfig& config) {
  Vector6d xi = -system.H.ldlt().solve(system.b);
  if (!xi.allFinite()) return Vector6d::Zero();
  const double longest =
      std::max(xi.head<3>().norm() / config.max_step_rad, xi.tail<3>().norm() / config.max_step_m);
  return longest > 1 ? Vector6d(xi / longest) : xi;
}

bool is_small(const Vector6d& xi, const registration::SolverConfig& config) {
  return xi.head<3>().norm() < config.stop_rad && xi.tail<3>().norm() < config.stop_m;
}

// Far from its place a camera must be turned by whatever can turn it: the picture's slopes do not
// reach so far, and surfaces whose rotation is left free promise a turn that nobody makes.
degeneracy::DegeneracyConfig weights_afar(degeneracy::DegeneracyConfig config) {
  constexpr double kAfar = 0.5;  // equations that also turn overstate more of what they know
  config.geometry_weight *= kAfar;
  config.geometry_turn_share = 1;
  return config;
}

// Every fourth normal is plenty.
double planarity_of(const registration::SourceCloud& source) {
  constexpr std::size_t kStride = 4;
  std::vector<Eigen::Vector3f> normals;
  for (std::size_t i = 0; i < source.points.size(); i += kStride) {
    normals.push_back(source.points[i].normal);
  }
  if (normals.empty()) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<float> equal(normals.size(), 1.0f);
  return degeneracy::planarity(normals, equal).eta;
}

/// The cells in which anything moves, and the share of the pixels that do.
std::pair<registration::CellMask, double> moving_cells(const PixelMask* still) {
  if (still == nullptr || still->empty()) return {};
  constexpr int kCell_px = 8;
  const int columns = (still->width() + kCell_px - 1) / kCell_px;
  const int rows = (still->height() + kCell_px - 1) / kCell_px;
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(columns * rows), 0);
  std::size_t moving = 0;
  for (int v = 0; v < still->height(); ++v) {
    for (int u = 0; u < still->width(); ++u) {
      if ((*still)(u, v) != 0) continue;
      cells[static_cast<std::size_t>(v / kCell_px * columns + u / kCell_px)] = 1;
      ++moving;
    }
  }
  return {registration::CellMask(kCell_px, columns, std::move(cells)),
          static_cast<double>(moving) / static_cast<double>(still->size())};
}

}  // namespace

Matrix6d Alignment::information() const {
  Matrix6d H = Matrix6d::Zero();
  if (geometry && geometry->holds) H += geometry->H;
  if (picture_holds()) H += picture->H;
  return H;
}

ReadoutModel known_readout(const registration::FrameMotion& motion) {
  constexpr double kCertain = 1e12;  // 1/rad^2
  const ReadoutEstimator::Belief belief{motion.readout, kCertain * Eigen::Matrix3d::Identity()};
  return {[belief](const SE3&) { return belief; },
          [motion](const Vector6d&, const SE3&) { return motion; }};
}

JointAligner::JointAligner(const AlignerConfig& config, const PinholeCamera& camera,
                           const SE3& T_local_world)
    : config_(config),
      afar_(weights_afar(config.degeneracy)),
      camera_(camera),
      past_(T_local_world),
      geometry_(config.geometry, camera, T_local_world),
      vision_(config.vision) {}

void JointAligner::look_at(const RgbdFrame& frame, const history::Revision& revision,
                           const map::SnapshotPtr& snapshot) {
  times_ = {};
  past_.set_revision(revision);
  {
    const CpuTimer timer(times_.points);
    std::tie(told_, told_share_) = moving_cells(frame.still.get());
    geometry_.set_frame(frame, past_, snapshot);
    geometry_.set_moving(told_);
    hysteresis_before_ = hysteresis_;
    observe_surfaces();
    planarity_ = planarity_of(geometry_.source());
  }
  const CpuTimer timer(times_.visual);
  vision_.set_frame(frame, past_);
  if (config_.geometry.movers.clusters) parts_.look_at(frame);
}

// Surfaces of what moves pin down no axis.
void JointAligner::observe_surfaces() {
  surfaces_ = geometry_.surface_information(config_.degeneracy.noise_stride);
  hysteresis_ = hysteresis_before_;
  observability_ = degeneracy::observe(surfaces_, config_.degeneracy, hysteresis_);
}

// Nothing of what is found to move is aligned, nor tells which axes are seen.
void JointAligner::leave_out(const registration::CellMask& found, VisualTerm::Fit& fit) {
  const registration::CellMask moving = told_.united(found);
  fit.set_moving(moving);
  if (geometry_.moving().cells() == moving.cells()) return;
  const CpuTimer timer(times_.points);
  geometry_.set_moving(moving);
  observe_surfaces();
}

LostReason JointAligner::check_frame() const { return check_points(source_points(), config_.loss); }

// What moves is left out, and what moves is told by where the camera is: both in turn. Where
// nothing moved lately, all of the frame is aligned first; and that pose stays if it explains more
// of the last half second than one without what seems to move.
Alignment JointAligner::align(const SE3& T_start, const ReadoutModel& readout, const References& to,
                              From from) {
  const bool looks = config_.geometry.movers.clusters && from == From::kNear && parts_.has_past() &&
                     T_start.all_finite();
  expected_.expect(from == From::kNear ? std::optional(T_start) : std::nullopt);
  std::optional<Alignment> whole;
  if (!looks || !parts_.moved()) {
    whole = align_without({}, T_start, readout, to, from);
    if (looks) whole->moving = judge_parts(whole->T_local_camera, readout);
    if (!whole->moving.mask.any()) {
      finish(to.surfaces, *whole);
      return std::move(*whole);
    }
  }
  MovingParts::Judgement expected = judge_parts(T_start, readout);
  Alignment a;
  constexpr int kTurns = 2;
  for (int i = 0; i < kTurns; ++i) {
    Alignment next = align_without(expected.mask, T_start, readout, to, from);
    next.moving = judge_parts(next.T_local_camera, readout);
    const bool settled = next.moving.mask.cells() == expected.mask.cells();
    if (i == 0 || next.moving.support >= a.moving.support) a = std::move(next);
    if (settled) break;
    expected = a.moving;
  }
  if (whole && whole->moving.support > a.moving.support) {
    a = align_without(whole->moving.mask, whole->T_local_camera, readout, to, from);
    a.moving = judge_parts(a.T_local_camera, readout);
  }
  leave_out(a.moving.mask, a.fit);
  geometry_.set_motion(a.points_motion);  // a turn that was not kept had another
  finish(to.surfaces, a);
  return a;
}

MovingParts::Judgement JointAligner::judge_parts(const SE3& T, const ReadoutModel& readout) {
  const CpuTimer timer(times_.points);
  return parts_.judge(T, readout.of_frame(Vector6d::Zero(), T), past_);
}

void JointAligner::remember(const Alignment& a) {
  expected_.learn(a.T_local_camera);
  if (config_.geometry.movers.clusters) parts_.remember(a.moving, a.points_motion);
}

// All but finish().
Alignment JointAligner::align_without(const registration::CellMask& found, const SE3& T_start,
                                      const ReadoutModel& readout, const References& to,
                                      From from) {
  Alignment a = start(T_start, readout, to);
  if (!T_start.all_finite()) return a;
  leave_out(found, a.fit);
  const int coarsest = a.fit.has_references() ? vision_.levels() - 1 : 0;
  for (int level = coarsest; level >= a.fit.finest_level(); --level) {
    if (level < coarsest) a.fit.update_belief(readout.belief(a.T_local_camera));
    a.points_motion = readout.of_frame(a.fit.readout(), a.T_local_camera);
    geometry_.set_motion(a.points_motion);
    align_level(level, to.surfaces, from, a);
  }
  return a;
}

Alignment JointAligner::measure(const SE3& T, const ReadoutModel& readout) {
  const bool with_geometry = can_be_registered();
  Alignment a = start(T, readout, {.surfaces = with_geometry});
  if (!T.all_finite()) return a;
  a.points_motion = readout.of_frame(a.fit.readout(), T);
  geometry_.set_motion(a.points_motion);
  if (a.fit.has_references()) {
    const CpuTimer timer(times_.visual);
    constexpr int kSteps = 5;  // gain and offset alone, robustly weighted
    for (int i = 0; i < kSteps; ++i) {
      a.fit.linearize(0, T);
      a.fit.back_substitute(Vector6d::Zero());
    }
  }
  finish(with_geometry, a);
  return a;
}

Alignment JointAligner::start(const SE3& T_start, const ReadoutModel& readout,
                              const References& to) {
  Alignment a;
  a.T_local_camera = T_start;
  a.lost_reason = LostReason::kNotFinite;
  if (!T_start.all_finite()) return a;
  const CpuTimer timer(times_.index);
  a.fit = vision_.start(T_start, to.pictures);
  a.fit.set_moving(told_);
  if (to.surfaces) geometry_.prepare(T_start);
  a.fit.set_readout(readout.belief(T_start));
  return a;
}

void JointAligner::finish(bool with_geometry, Alignment& a) {
  if (with_geometry) a.geometry = geometry_at(a.T_local_camera);
  if (a.fit.has_references()) a.picture = picture_at(a.T_local_camera, a.fit);
  a.lost_reason = judge(a);
}

void JointAligner::align_level(int level, bool with_geometry, From from, Alignment& a) {
  const degeneracy::DegeneracyConfig& weights = from == From::kAfar ? afar_ : config_.degeneracy;
  for (int i = 0; i < config_.alignment.max_iterations; ++i) {
    ++a.iterations;
    degeneracy::NormalEquations geometry, vision;
    if (with_geometry) geometry = linearize_geometry(level, a.T_local_camera);
    const CpuTimer timer(times_.visual);
    if (a.fit.has_references()) {
      vision = a.fit.linearize(level, a.T_local_camera);
      // A handful of pixels at a coarse level would only pull the pose somewhere.
      if (a.fit.used() < config_.alignment.min_pixels) vision = {};
    }
    if (geometry_.moving().any()) {
      if (const auto prior = expected_.prior(a.T_local_camera)) {
        degeneracy::add_prior(*prior, a.T_local_camera, vision);
      }
    }
    const auto joint = config_.fusion == Fusion::kRemove
                           ? degeneracy::fuse_removed(geometry, observability_.K, vision, weights)
                           : degeneracy::fuse_joint(geometry, vision, weights);
    const Vector6d xi = capped_step(joint, config_.solver);
    a.T_local_camera = a.T_local_camera * SE3::exp(xi);
    a.fit.back_substitute(xi);
    if (is_small(xi, config_.solver)) break;
  }
}

degeneracy::NormalEquations JointAligner::linearize_geometry(int level, const SE3& T) {
  const CpuTimer timer(times_.geometry);
  return normal_equations(level > 0 ? geometry_.linearize_coarse(T, config_.alignment.coarse_stride)
                                    : geometry_.linearize(T));
}

Alignment::Geometry JointAligner::geometry_at(const SE3& T) {
  const CpuTimer timer(times_.geometry);
  const auto l = geometry_.linearize(T);
  const Matrix6d K =
      config_.fusion == Fusion::kRemove ? observability_.K : Matrix6d(Matrix6d::Identity());
  Alignment::Geometry g;
  g.inliers = l.inliers;
  g.cost = l.error;
  g.movers = told_share_ + (1 - told_share_) * geometry_.count_movers(T);
  g.overlap = geometry_.overlap(T);
  g.spectrum = degeneracy::spectrum(l.H);
  g.H = degeneracy::fuse_removed(normal_equations(l), K, {}, config_.degeneracy).H;
  g.holds = check_matches(g.inliers, source_points(), config_.loss) == LostReason::kNone;
  return g;
}

Alignment::Picture JointAligner::picture_at(const SE3& T, VisualTerm::Fit& fit) {
  const CpuTimer timer(times_.visual);
  Alignment::Picture p;
  const auto equations = fit.linearize(fit.finest_level(), T);
  p.H = equations.H;
  p.b = equations.b;
  p.pixels = fit.used();
  p.mean_cost = fit.mean_cost();
  p.holds =
      p.pixels >= config_.alignment.min_pixels && p.mean_cost <= config_.alignment.max_mean_cost;
  return p;
}

// Whether geometry and vision together pin down all six axes.
LostReason JointAligner::judge(const Alignment& a) const {
  const bool geometry_holds = a.geometry && a.geometry->holds;
  Matrix6d H_vision = Matrix6d::Zero();  // on the scaled and centred twists of the axes
  if (a.picture_holds()) {
    const Matrix6d A = surfaces_.camera_from_scaled();
    H_vision = A.transpose() * a.picture->H * A;
  }
  for (int k = 0; k < 6; ++k) {
    const bool seen = geometry_holds && ((observability_.mask >> k) & 1u) == 0;
    const Vector6d axis = observability_.axes.col(k);
    const bool filled = axis.dot(H_vision * axis) >= config_.alignment.min_information;
    if (!seen && !filled) return why_unseen(a);  // not filled: also where it is not a number
  }
  return LostReason::kNone;
}

// What kept an axis from being seen: geometry is asked first.
LostReason JointAligner::why_unseen(const Alignment& a) const {
  const LostReason points = check_frame();
  if (points != LostReason::kNone) return points;
  if (!a.geometry || !a.geometry->holds) return LostReason::kTooFewMatches;
  if (!a.picture || a.picture->pixels < config_.alignment.min_pixels) {
    return LostReason::kTooFewPixels;
  }
  return a.picture->holds ? LostReason::kUnseenAxis : LostReason::kPoorPictureFit;
}

std::shared_ptr<const PixelMask> JointAligner::still_pixels(const RgbdFrame& frame,
                                                            const Alignment& a) const {
  if (!a.geometry || a.geometry->movers <= 0) return nullptr;
  constexpr int kBlock_px = 8;
  const int columns = (camera_.width + kBlock_px - 1) / kBlock_px;
  const int rows = (camera_.height + kBlock_px - 1) / kBlock_px;
  PixelMask still(camera_.width, camera_.height, std::uint8_t{1});
  const auto blank = [&](int column, int row) {  // a block and its neighbours: silhouettes
    for (int v = std::max(0, (row - 1) * kBlock_px);
         v < std::min(camera_.height, (row + 2) * kBlock_px); ++v) {
      const int begin = std::max(0, (column - 1) * kBlock_px);
      const int end = std::min(camera_.width, (column + 2) * kBlock_px);
      std::fill(still.row(v) + begin, still.row(v) + end, std::uint8_t{0});
    }
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int u = std::min(column * kBlock_px + kBlock_px / 2, camera_.width - 1);
      const int v = std::min(row * kBlock_px + kBlock_px / 2, camera_.height - 1);
      const float z = frame.depth(u, v);
      const Eigen::Vector3f point = camera_.back_project(u, v, double{z}).cast<float>();
      if (z > 0 ? geometry_.moves(point, a.T_local_camera) : geometry_.moves(u, v)) {
        blank(column, row);
      }
    }
  }
  return std::make_shared<const PixelMask>(std::move(still));
}

// Of the pixel, unless what is seen there moves.
registration::InverseDepthPlane JointAligner::still_surface(int u, int v,
                                                            const Alignment& a) const {
  const auto plane = geometry_.surface_with_colour(u, v, a.points_motion.lag());
  if (!(plane.q > 0) || !a.geometry || a.geometry->movers <= 0) return plane;
  const Eigen::Vector3f point = camera_.back_project(u, v, 1 / double{plane.q}).cast<float>();
  return geometry_.moves(point, a.T_local_camera) ? registration::InverseDepthPlane{} : plane;
}

void JointAligner::begin(const SE3& T_local_camera, const registration::FrameMotion& motion) {
  Alignment a;
  a.T_local_camera = T_local_camera;
  a.points_motion = motion;
  a.geometry.emplace();
  a.geometry->movers = told_share_;
  a.moving = parts_.told(told_);
  extend(a, motion.readout);
  remember(a);
}

void JointAligner::take_drawing(const SE3& T_local_camera) {
  vision_.insert_drawing(T_local_camera, [&](int u, int v) { return still_surface(u, v, {}); });
}

JointAligner::Extension JointAligner::extend(const Alignment& a, const Vector6d& readout) {
  Extension out;
  vision_.compare_references(a.fit);
  if (check_frame() != LostReason::kNone) return out;
  if (a.geometry) geometry_.note_movers(a.T_local_camera);
  if (vision_.wants_keyframe(a.T_local_camera, a.fit)) {
    const int before = vision_.keyframes();
    vision_.insert_keyframe(a.T_local_camera, a.fit, readout, a.points_motion,
                            [&](int u, int v) { return still_surface(u, v, a); });
    out.keyframe = vision_.keyframes() > before;
  }
  const bool unexplained =
      a.geometry && a.geometry->overlap < config_.geometry.keyframe.min_overlap;
  if (geometry_.has_targets() && !unexplained) return out;
  geometry_.insert_keyframe(a.T_local_camera, a.points_motion);
  out.targets = true;
  return out;
}

}  // namespace sgs::alignment
