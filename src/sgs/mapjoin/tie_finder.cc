// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/tie_finder.h"

#include <algorithm>
#include <utility>

#include "sgs/camera/resample.h"
#include "sgs/registration/view_distance.h"
#include "sgs/slam/loop_back_end.h"
#include "sgs/slam/metre_check.h"

namespace sgs::mapjoin {
namespace {

constexpr double kInSight = 0.3;  // image widths and depths: two nodes of a path

/// Which of the two worlds the first view of the other map is in nobody knows.
graph::UncertainPose unknown_way() {
  constexpr double kAnywhere = 1e4;  // m^2 and rad^2
  return {SE3{}, kAnywhere * Matrix6d::Identity()};
}

}  // namespace

TieFinder::TieFinder(const loops::LoopConfig& config, const tracker::TrackerConfig& tracker,
                     const Part& both, std::size_t first)
    : both_(both),
      first_(first),
      config_(config),
      camera_(both.sessions[both.graph.session[first - 1]].camera),
      verifier_(config, slam::pair_config(tracker)),
      closer_(config, slam::pair_config(tracker), 0,
              std::make_shared<history::ViewStore>(history::HistoryConfig{})),
      relocaliser_(tracker::SpectralConfig(tracker).relocaliser) {
  std::vector<const graph::Edge*> ways(both.views(), nullptr);  // to each view
  for (const graph::Edge& e : both.graph.edges) {
    if (!e.doubtful && e.to == e.from + 1) ways[static_cast<std::size_t>(e.to)] = &e;
  }
  history::Revision revision;
  for (std::size_t i = 0; i < both.views(); ++i) {
    const alignment::KnownView view = both.view(i);
    const RgbdFrame seen = frame(view, i);
    revision.path.append({seen.index, seen.timestamp_s, view.T_world_camera});
    std::optional<graph::UncertainPose> way;
    if (ways[i] != nullptr) way = {ways[i]->T_from_to, ways[i]->information.inverse()};
    if (i == first) way = unknown_way();
    closer_.know(view, seen, revision, way);
    if (i < first) relocaliser_.know(view, seen);
  }
  past_.set_revision(revision);
}

/// What the camera of the base would have seen, under the view's index and time in the path.
RgbdFrame TieFinder::frame(const alignment::KnownView& view, std::size_t number) const {
  RgbdFrame frame = resampled(view.frame, camera_);
  frame.index = alignment::known_view_index(number);
  frame.timestamp_s = alignment::known_view_time_s(number);
  return frame;
}

std::optional<graph::Edge> TieFinder::look_for(std::size_t number) {
  const alignment::KnownView view = both_.view(number);
  const auto T = relocaliser_.relocalise(frame(view, number), past_, &view);
  ++search_.looked;
  const tracker::Relocaliser::Look& look = relocaliser_.last_look();
  if (std::pair(look.inliers, look.matches) >
      std::pair(search_.best_inliers, search_.best_matches)) {
    search_.best_inliers = look.inliers;
    search_.best_matches = look.matches;
    search_.best_view_s = view.timestamp_s;
    const auto base = static_cast<std::size_t>(look.keyframe - alignment::known_view_index(0));
    search_.best_base_s = both_.times_s.at(base);
  }
  if (!T) return std::nullopt;
  ++search_.recognised;
  auto tie = look_at(number, *T);
  if (tie) ++search_.verified;
  return tie;
}

// The views of the base by how much less they see of what a camera sees at a place.
std::vector<std::pair<double, int>> TieFinder::nearest(const SE3& T_base_camera) const {
  std::vector<std::pair<double, int>> out;
  for (int k = 0; k < static_cast<int>(first_); ++k) {
    const SE3 T = both_.T_world_camera[static_cast<std::size_t>(k)].inverse() * T_base_camera;
    const double depth_m = pose_graph().node(k).mean_depth_m;
    out.emplace_back(registration::view_distance(camera_, depth_m, T), k);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::optional<graph::Edge> TieFinder::look_at(std::size_t number, const SE3& T_base_camera) const {
  constexpr std::size_t kTried = 2;
  auto places = nearest(T_base_camera);
  places.resize(std::min(places.size(), kTried));
  for (const auto& [distance, k] : places) {
    // What is measured may be nearer than what was expected.
    if (distance > config_.revisit_distance + kInSight) break;
    const SE3 T = both_.T_world_camera[static_cast<std::size_t>(k)].inverse() * T_base_camera;
    if (auto tie = verifier_.verify(pose_graph(), k, static_cast<int>(number), T)) return tie;
  }
  return std::nullopt;
}

bool TieFinder::is_in_sight(const SE3& T_base_camera) const {
  const auto places = nearest(T_base_camera);
  return !places.empty() && places.front().first < kInSight;
}

std::optional<double> TieFinder::metre(const std::vector<graph::Edge>& ties) const {
  constexpr int kLeast = 5, kMost = 30;
  if (std::ssize(ties) < kLeast) return std::nullopt;
  slam::MetreCheck check(std::min(kMost, static_cast<int>(ties.size())));
  for (std::size_t i = 0; i < first_; ++i) {
    check.know(alignment::known_view_index(i), frame(both_.view(i), i));
  }
  for (const graph::Edge& tie : ties) {
    const auto number = static_cast<std::size_t>(tie.to);
    const SE3 T = both_.T_world_camera[static_cast<std::size_t>(tie.from)] * tie.T_from_to;
    if (check.add(frame(both_.view(number), number), T, past_.revision().path)) break;
  }
  return check.ratio();
}

}  // namespace sgs::mapjoin
