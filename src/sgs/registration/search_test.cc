// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "sgs/registration/correspondence_search.h"
#include "sgs/registration/nearest_forest.h"

namespace sgs::registration {
namespace {

const PinholeCamera kSearchCamera{320, 240, 270, 268, 159.3, 121.1};

class Random {
 public:
  float operator()(float low, float high) {
    return low + (high - low) * static_cast<float>(engine_() >> 11) * 0x1.0p-53f;
  }
  Eigen::Vector3f point() { return {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)}; }

 private:
  std::mt19937_64 engine_{7};
};

int brute_force(const TargetCloud& cloud, const Eigen::Vector3f& q, float max_distance) {
  float best = max_distance * max_distance;
  int found = -1;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const float d = (cloud.points[i].point - q).squaredNorm();
    if (cloud.points[i].alive() && d < best) {
      best = d;
      found = static_cast<int>(i);
    }
  }
  return found;
}

void expect_equals_brute_force(const NearestForest& forest, const TargetCloud& cloud, Random& r) {
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3f q = 1.1f * r.point();
    const float limit = k % 2 ? 10.0f : 0.15f;
    EXPECT_EQ(forest.nearest(q, limit), brute_force(cloud, q, limit));
  }
}

TEST(NearestForest, EqualsBruteForceWhileGrowing) {
  Random r;
  TargetCloud cloud;
  NearestForest forest;
  EXPECT_EQ(forest.nearest({0, 0, 0}, 10), -1);
  for (const int added : {700, 40, 60, 1, 0, 300, 500, 20}) {
    for (int k = 0; k < added; ++k) cloud.points.push_back({r.point(), {0, 0, 1}, 1e-6f});
    forest.update(cloud);
    expect_equals_brute_force(forest, cloud, r);
  }
}

TEST(NearestForest, FollowsMovedAndRemovedTargetsAndANewLayout) {
  Random r;
  TargetCloud cloud;
  NearestForest forest;
  for (int k = 0; k < 1000; ++k) cloud.points.push_back({r.point(), {0, 0, 1}, 1e-6f});
  forest.update(cloud);
  for (std::size_t i = 0; i < 1000; i += 3) cloud.points[i].point = r.point();
  for (std::size_t i = 1; i < 1000; i += 5) cloud.points[i].variance_m2 = 0;
  forest.update(cloud);
  expect_equals_brute_force(forest, cloud, r);
  for (std::size_t i = 1; i < 1000; i += 10) cloud.points[i].variance_m2 = 1e-6f;  // back again
  forest.update(cloud);
  expect_equals_brute_force(forest, cloud, r);
  cloud.points.resize(300);
  for (auto& p : cloud.points) p = {r.point(), {0, 0, 1}, 1e-6f};
  ++cloud.layout;
  forest.update(cloud);
  expect_equals_brute_force(forest, cloud, r);
}

TEST(NearestForest, IndexesEachPointAFewTimesOnly) {
  Random r;
  TargetCloud cloud;
  NearestForest forest;
  constexpr std::size_t kBatches = 200, kBatch = 50;
  for (std::size_t k = 0; k < kBatches; ++k) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      cloud.points.push_back({r.point(), {0, 0, 1}, 1e-6f});
    }
    forest.update(cloud);
    forest.update(cloud);  // nothing new: free
  }
  // Rebuilding per batch would index about kBatches / 2 = 100 times as many entries as there are
  // points; the logarithmic method at most log2(kBatches) + 1 = 8.6 times.
  EXPECT_LT(forest.entries_indexed(), 9 * kBatches * kBatch);
  EXPECT_LE(forest.trees(), 9u);
}

TargetPoint facing_target(const Eigen::Vector3f& point, const SE3& T_local_camera) {
  const Eigen::Vector3f eye = T_local_camera.t.cast<float>();
  return {point, (eye - point).normalized(), 1e-6f};
}

SourcePoint source_at(const Eigen::Vector3f& point) {
  SourcePoint s;
  s.point = point;
  s.normal = -point.normalized();
  s.variance_m2 = 1e-6f;
  return s;
}

class SearchTest : public testing::TestWithParam<SearchMethod> {
 protected:
  SearchTest() {
    config_.method = GetParam();
    search_ = make_search(config_, kSearchCamera);
  }
  SearchConfig config_;
  std::unique_ptr<CorrespondenceSearch> search_;
};

TEST_P(SearchTest, FindsEachPointsOwnTarget) {
  const SE3 T_local_camera(so3_exp({0.3, -0.5, 0.2}), {1.5, -2, 0.7});
  TargetCloud cloud;
  SourceCloud source;
  std::vector<std::size_t> own;
  for (int v = 20; v < 220; v += 20) {
    for (int u = 20; u < 300; u += 20) {
      const Eigen::Vector3d p = kSearchCamera.back_project(u, v, 1.0 + 0.001 * u);
      source.points.push_back(source_at(p.cast<float>()));
      // The list runs backwards, and the target lies a centimetre deeper.
      const Eigen::Vector3d q = T_local_camera * Eigen::Vector3d(p * (1 + 0.01 / p.norm()));
      cloud.points.insert(cloud.points.begin(), facing_target(q.cast<float>(), T_local_camera));
    }
  }
  // The prediction is a little off.
  Vector6d xi;
  xi << 0.003, -0.002, 0.004, 0.004, 0.003, -0.005;
  search_->prepare(cloud, T_local_camera * SE3::exp(xi));
  const SE3 T_reference_camera = search_->T_local_reference().inverse() * T_local_camera;
  std::vector<int> matches;
  search_->match(source, T_reference_camera, matches);
  ASSERT_EQ(matches.size(), source.points.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    ASSERT_GE(matches[i], 0) << i;
    const Eigen::Vector3d found =
        search_->T_local_reference() *
        search_->targets()[static_cast<std::size_t>(matches[i])].point.cast<double>();
    const Eigen::Vector3d wanted = cloud.points[cloud.points.size() - 1 - i].point.cast<double>();
    EXPECT_LT((found - wanted).norm(), 1e-5);
  }
}

TEST_P(SearchTest, GatesByDistanceAndFindsNothingInAnEmptyMap) {
  TargetCloud cloud;
  SourceCloud source;
  source.points.push_back(source_at({0, 0, 1.5f}));
  std::vector<int> matches;
  search_->prepare(cloud, SE3{});
  search_->match(source, SE3{}, matches);
  EXPECT_EQ(matches, std::vector<int>{CorrespondenceSearch::kNoMatch});
  cloud.points.push_back(facing_target({0, 0, 1.56f}, SE3{}));
  search_->prepare(cloud, SE3{});
  search_->match(source, SE3{}, matches);
  EXPECT_EQ(matches, std::vector<int>{CorrespondenceSearch::kNoMatch});
  cloud.points.push_back(facing_target({0, 0, 1.46f}, SE3{}));
  search_->prepare(cloud, SE3{});
  search_->match(source, SE3{}, matches);
  EXPECT_GE(matches[0], 0);
  EXPECT_TRUE(search_->occupied({0, 0, 1.47f}, {0, 0, -1}, 0.02f, 0.03f));
  EXPECT_FALSE(search_->occupied({0.3f, 0, 1.47f}, {0, 0, -1}, 0.02f, 0.03f));
}

INSTANTIATE_TEST_SUITE_P(Methods, SearchTest,
                         testing::Values(SearchMethod::kProjective, SearchMethod::kNearest));

TEST(ProjectiveSearch, NearestInDepthWinsAndBacksAreInvisible) {
  SearchConfig config;
  const auto search = make_search(config, kSearchCamera);
  TargetCloud cloud;
  const Eigen::Vector3f ray(0.001f, 0.001f, 1);
  cloud.points.push_back({2.0f * ray, {0, 0, -1}, 1e-6f});
  cloud.points.push_back({1.0f * ray, {0, 0, 1}, 1e-6f});   // seen from behind
  cloud.points.push_back({1.5f * ray, {0, 0, -1}, 1e-6f});  // this one is visible
  cloud.points.push_back({1.2f * ray, {0, 0, -1}, 0});      // removed
  search->prepare(cloud, SE3{});
  ASSERT_EQ(search->targets().size(), 1u);
  EXPECT_FLOAT_EQ(search->targets()[0].point.z(), 1.5f);
}

TEST(ProjectiveSearch, DisagreeingNormalsDoNotMatch) {
  const auto search = make_search(SearchConfig{}, kSearchCamera);
  TargetCloud cloud;
  cloud.points.push_back({{0, 0, 1.5f}, Eigen::Vector3f(0.8f, 0, -0.6f), 1e-6f});
  search->prepare(cloud, SE3{});
  SourceCloud source;
  source.points.push_back(source_at({0, 0, 1.5f}));
  std::vector<int> matches;
  search->match(source, SE3{}, matches);
  EXPECT_EQ(matches[0], CorrespondenceSearch::kNoMatch);
}

TEST(ProjectiveSearch, PointsBehindBesideAndAtInfinityAreIgnored) {
  const auto search = make_search(SearchConfig{}, kSearchCamera);
  TargetCloud cloud;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  cloud.points.push_back({{0, 0, -1}, {0, 0, 1}, 1e-6f});
  cloud.points.push_back({{50, 0, 1}, {-1, 0, 0}, 1e-6f});
  cloud.points.push_back({{nan, 0, 1}, {0, 0, -1}, 1e-6f});
  cloud.points.push_back({{0, 0, nan}, {0, 0, -1}, 1e-6f});
  search->prepare(cloud, SE3{});
  EXPECT_TRUE(search->targets().empty());
}

TEST(ProjectiveSearch, TellsWhatStandsBeforeAllThatIsKnown) {
  TargetCloud wall;  // at 2 m, in the left half of the picture
  for (int v = 0; v < 240; v += 4) {
    for (int u = 0; u < 160; u += 4) {
      wall.points.push_back({kSearchCamera.back_project(u, v, 2).cast<float>(), {0, 0, -1}, 1e-6f});
    }
  }
  const auto search = make_search({}, kSearchCamera);
  search->prepare(wall, SE3{});
  const auto at = [](int u, float z) {
    return Eigen::Vector3f(kSearchCamera.back_project(u, 120, double{z}).cast<float>());
  };
  EXPECT_TRUE(search->stands_before(at(80, 1.5f), 0.1f));
  EXPECT_FALSE(search->stands_before(at(80, 1.95f), 0.1f)) << "on the wall";
  EXPECT_FALSE(search->stands_before(at(80, 2.5f), 0.1f)) << "behind it";
  EXPECT_FALSE(search->stands_before(at(240, 1.5f), 0.1f)) << "nothing is known there";
  SearchConfig nearest;
  nearest.method = SearchMethod::kNearest;
  const auto other = make_search(nearest, kSearchCamera);
  other->prepare(wall, SE3{});
  EXPECT_FALSE(other->stands_before(at(80, 1.5f), 0.1f));
}

}  // namespace
}  // namespace sgs::registration
