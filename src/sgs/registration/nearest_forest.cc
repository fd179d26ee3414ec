// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/nearest_forest.h"

#include <nanoflann.hpp>

namespace sgs::registration {
namespace forest {  // named, since State holds them

struct Entry {
  Eigen::Vector3f position;  // where the target was when it was indexed
  std::int32_t target;
  std::uint32_t revision;  // alive while it equals the target's
};

// What nanoflann asks of a data set.
struct EntryCloud {
  std::vector<Entry> entries;
  std::size_t kdtree_get_point_count() const { return entries.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return entries[i].position[static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

struct Tree {
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, EntryCloud>,
                                                    EntryCloud, 3, std::uint32_t>;
  explicit Tree(std::vector<Entry> entries)
      : cloud{std::move(entries)}, index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    index.buildIndex();
  }
  EntryCloud cloud;
  Index index;
};

// nanoflann result set: the nearest entry that is still alive, shared by all trees of a query.
class NearestAlive {
 public:
  using DistanceType = float;

  NearestAlive(float max_distance2, const std::vector<std::uint32_t>& revisions)
      : best_(max_distance2), revisions_(revisions) {}
  void search_in(const std::vector<Entry>& entries) { entries_ = &entries; }
  std::size_t size() const { return target_ >= 0 ? 1 : 0; }
  bool full() const { return true; }
  float worstDist() const { return best_; }
  bool addPoint(float distance2, std::uint32_t index) {
    const Entry& entry = (*entries_)[index];
    if (distance2 < best_ && entry.revision == revisions_[static_cast<std::size_t>(entry.target)]) {
      best_ = distance2;
      target_ = entry.target;
    }
    return true;
  }
  int target() const { return target_; }

 private:
  float best_;
  int target_ = -1;
  const std::vector<std::uint32_t>& revisions_;
  const std::vector<Entry>* entries_ = nullptr;
};

}  // namespace forest

struct NearestForest::State {
  std::vector<std::unique_ptr<forest::Tree>> trees;  // sizes fall from front to back
  std::vector<std::uint32_t> revisions;              // per target; odd = not in the index
  std::vector<Eigen::Vector3f> positions;            // per target, as indexed
  std::uint64_t layout = 0;
  std::size_t entries_indexed = 0;

  bool is_alive(const forest::Entry& e) const {
    return e.revision == revisions[static_cast<std::size_t>(e.target)];
  }
  void add_tree(std::vector<forest::Entry> entries);
};

void NearestForest::State::add_tree(std::vector<forest::Entry> entries) {
  if (entries.empty()) return;
  while (!trees.empty() && trees.back()->cloud.entries.size() < 2 * entries.size()) {
    for (const forest::Entry& e : trees.back()->cloud.entries) {
      if (is_alive(e)) entries.push_back(e);
    }
    trees.pop_back();
  }
  entries_indexed += entries.size();
  trees.push_back(std::make_unique<forest::Tree>(std::move(entries)));
}

NearestForest::NearestForest() : state_(std::make_unique<State>()) {}
NearestForest::~NearestForest() = default;
NearestForest::NearestForest(NearestForest&&) noexcept = default;
NearestForest& NearestForest::operator=(NearestForest&&) noexcept = default;

void NearestForest::update(const TargetCloud& cloud, float tolerance_m) {
  State& s = *state_;
  if (cloud.layout != s.layout || cloud.points.size() < s.revisions.size()) {
    s.trees.clear();
    s.revisions.clear();
    s.positions.clear();
    s.layout = cloud.layout;
  }
  const float tolerance2 = tolerance_m * tolerance_m;
  std::vector<forest::Entry> fresh;
  s.revisions.resize(cloud.points.size(), 1);
  s.positions.resize(cloud.points.size(), Eigen::Vector3f::Zero());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const TargetPoint& p = cloud.points[i];
    const bool indexed = s.revisions[i] % 2 == 0;
    if (indexed && p.alive() && (p.point - s.positions[i]).squaredNorm() <= tolerance2) continue;
    if (indexed) ++s.revisions[i];
    if (!p.alive()) continue;
    ++s.revisions[i];
    s.positions[i] = p.point;
    fresh.push_back({p.point, static_cast<std::int32_t>(i), s.revisions[i]});
  }
  s.add_tree(std::move(fresh));
}

int NearestForest::nearest(const Eigen::Vector3f& query, float max_distance_m) const {
  forest::NearestAlive result(max_distance_m * max_distance_m, state_->revisions);
  for (const auto& tree : state_->trees) {
    result.search_in(tree->cloud.entries);
    tree->index.findNeighbors(result, query.data(), nanoflann::SearchParams());
  }
  return result.target();
}

std::size_t NearestForest::trees() const { return state_->trees.size(); }
std::size_t NearestForest::entries_indexed() const { return state_->entries_indexed; }

}  // namespace sgs::registration
