// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/join.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sgs/camera/resample.h"
#include "sgs/loops/agreeing_poses.h"
#include "sgs/mapjoin/agreement.h"
#include "sgs/mapjoin/even_colours.h"
#include "sgs/mapjoin/in_the_air.h"
#include "sgs/mapjoin/move_part.h"
#include "sgs/mapjoin/one_graph.h"

namespace sgs::mapjoin {
namespace {

constexpr std::size_t kNeeded = 3;       // views that agree
constexpr std::size_t kEnough = 8;       // with so many nobody needs to look on
constexpr double kLeastConfirmed = 0.5;  // of the views that should see the base
constexpr double kAnotherMetre = 0.015;

/// The numbers of a range, spread over all of it from the first on: every 16th, those halfway
/// between, and so on.
std::vector<std::size_t> spread(std::size_t first, std::size_t end) {
  std::vector<std::size_t> out;
  for (std::size_t step = 16, begin = 0; step > 0; begin = step / 2, step /= 2) {
    const std::size_t stride = begin == 0 ? step : 2 * begin;
    for (std::size_t i = first + begin; i < end; i += stride) out.push_back(i);
  }
  return out;
}

/// No other place may be nearly as likely.
bool is_sure(const Agreement& a) { return a.ties.size() >= kNeeded && a.ties.size() > 2 * a.rival; }

Agreement first_ties(TieFinder& finder, const Part& both, std::size_t first,
                     std::vector<graph::Edge>& ties, const loops::DriftConfig& drift) {
  Agreement agreement;
  for (const std::size_t number : spread(first, both.views())) {
    const auto tie = finder.look_for(number);
    if (!tie) continue;
    ties.push_back(*tie);
    agreement = agreement_of(ties, both.T_world_camera, drift);
    if (agreement.ties.size() >= kEnough && is_sure(agreement)) break;
  }
  return agreement;
}

/// Every view of the other map that should see the base, looked for where it should be.
std::vector<graph::Edge> all_ties(const TieFinder& finder, const std::vector<SE3>& poses,
                                  std::size_t first, ThreadPool& pool, Outcome& outcome) {
  std::vector<std::optional<graph::Edge>> found(poses.size() - first);
  std::vector<char> in_sight(found.size(), 0);
  pool.run(static_cast<int>(found.size()), [&](int chunk, int) {
    const auto i = static_cast<std::size_t>(chunk);
    const SE3& T = poses[first + i];
    in_sight[i] = finder.is_in_sight(T) ? 1 : 0;
    found[i] = finder.look_at(first + i, T);
  });
  std::vector<graph::Edge> ties;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i]) ties.push_back(*found[i]);
    if (in_sight[i] == 0) continue;
    ++outcome.expected;
    if (found[i]) ++outcome.confirmed;
  }
  return ties;
}

/// Poses with which neighbours show things in the same place, as a run leaves them.
std::vector<SE3> settled(Part part, std::vector<SE3> poses, const loops::LoopConfig& config,
                         const tracker::TrackerConfig& tracker, ThreadPool& pool) {
  const PinholeCamera camera = part.sessions.front().camera;
  place_views(part, std::move(poses));
  const auto view = [&](std::size_t number) {
    alignment::KnownView out = part.view(number);
    out.frame = resampled(std::move(out.frame), camera);
    return out;
  };
  return loops::agreeing_poses({part.views(), view}, config, tracker::aligner_config(tracker),
                               pool);
}

}  // namespace

Outcome join(Part& base, const Part& other, ThreadPool& pool) {
  const loops::LoopConfig config;
  const tracker::TrackerConfig tracker;
  const std::size_t first = base.views();
  Part both = side_by_side(base, other);
  TieFinder finder(config, tracker, both, first);
  Outcome outcome;
  std::vector<graph::Edge> ties;
  const Agreement agreement = first_ties(finder, both, first, ties, config.drift);
  outcome.search = finder.search();
  outcome.agreed = agreement.ties.size();
  outcome.rival = agreement.rival;
  outcome.metre = finder.metre(is_sure(agreement) ? agreement.ties : ties);
  if (!is_sure(agreement)) return outcome;

  OneGraph graph =
      one_graph(both, first, finder.pose_graph(), agreement.ties, agreement.T_base_other);
  if (!graph.solved || graph.ties < kNeeded) return outcome;
  ties = all_ties(finder, graph.T_world_camera, first, pool, outcome);
  if (outcome.confirmed < kLeastConfirmed * outcome.expected) return outcome;
  graph = one_graph(both, first, finder.pose_graph(), ties,
                    graph.T_world_camera[first] * both.T_world_camera[first].inverse());
  outcome.ties = graph.ties;
  if (!graph.solved || graph.ties < kNeeded) return outcome;
  if (const auto metre = finder.metre(ties)) outcome.metre = metre;

  std::vector<SE3> poses = settled(both, std::move(graph.T_world_camera), config, tracker, pool);
  // The world is that of the base: its first view stays.
  const SE3 back = both.T_world_camera.front() * poses.front().inverse();
  for (SE3& T : poses) T = (back * T).normalized();
  poses.front() = both.T_world_camera.front();
  outcome.T_base_other = poses[first] * both.T_world_camera[first].inverse();
  both.graph.edges = at_rest(std::move(graph.edges), poses);
  outcome.merged = move_part(both, std::move(poses));
  outcome.colours = even_colours(both, static_cast<std::uint16_t>(base.sessions.size()));
  outcome.dropped = drop_in_the_air(both, static_cast<std::uint16_t>(base.sessions.size()));
  base = std::move(both);
  outcome.joined = true;
  return outcome;
}

std::string Outcome::sentence() const {
  const std::string looked = fmt::format("{} views compared, {} recognised, {} fit", search.looked,
                                         search.recognised, search.verified);
  std::string out;
  if (joined) {
    out = fmt::format(
        "{}; {} of {} that should see it do, {} ties; its world is turned by {:.2f} degrees and "
        "shifted by {:.3f} m; {} Gaussians were there twice, {} hung in the air; "
        "its colours were multiplied by {:.2f} {:.2f} {:.2f}",
        looked, confirmed, expected, ties, T_base_other.angle() * 180 / std::numbers::pi,
        T_base_other.t.norm(), merged, dropped, colours[0], colours[1], colours[2]);
  } else if (expected > 0 && agreed >= kNeeded) {
    out = fmt::format(
        "{} views agree on a place ({}), but there only {} of {} views see what they should",
        agreed, looked, confirmed, expected);
  } else {
    out = fmt::format("at most {} views agree on one place{}, {} are needed ({})", agreed,
                      rival > 0 ? fmt::format(" and {} on another", rival) : "", kNeeded, looked);
  }
  if (!joined && search.best_matches > 0) {
    out += fmt::format(
        "; best guess: its view at {:.3f} s is that at {:.3f} s, {} features agree ({} alike)",
        search.best_view_s, search.best_base_s, search.best_inliers, search.best_matches);
  }
  if (metre && std::abs(*metre - 1) >= kAnotherMetre) {
    out += fmt::format("; its depth is {:.1f} % {}: calibrate its camera (`sgs calibrate`)",
                       100 * std::abs(*metre - 1), *metre > 1 ? "longer" : "shorter");
  }
  return out;
}

}  // namespace sgs::mapjoin
