// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/mapper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "sgs/history/test_spill.h"
#include "sgs/mapper/keyframe_refinement.h"
#include "sgs/mapper/test_wall_scene.h"

namespace sgs::mapper {
namespace {

double psnr_db(const map::Snapshot& snapshot, const RgbdFrame& frame, const SE3& T) {
  render::Rendering rendering;
  render::make_cpu_rasterizer(nullptr)->render(snapshot.gaussians, frame.camera, T, rendering);
  double sum = 0;
  for (std::size_t i = 0; i < frame.color.size(); ++i) {
    const Rgb8& y = frame.color.data()[i];
    const render::Rgbf& r = rendering.color.data()[i];
    for (const auto& [a, b] : {std::pair{r.r, y.r}, {r.g, y.g}, {r.b, y.b}}) {
      const double e = std::clamp(static_cast<double>(a), 0.0, 1.0) - b / 255.0;
      sum += e * e;
    }
  }
  return -10 * std::log10(sum / (3.0 * static_cast<double>(frame.color.size())));
}

MapperConfig config_for_test() {
  MapperConfig config;
  config.insertion.leaf_max_px = 8;
  return config;
}

/// A mapper that has seen the wall from five places.
std::unique_ptr<Mapper> trained(const MapperConfig& config, ThreadPool* pool, int iterations) {
  auto mapper = std::make_unique<Mapper>(config, small_camera(), 3, pool);
  for (int i = 0; i < 5; ++i) {
    const SE3 T = translated(0.1 * i, 0.02 * i, 0);
    mapper->add_keyframe(wall_frame(small_camera(), T, i), T);
    mapper->iterate(iterations);
  }
  return mapper;
}

TEST(Mapper, VisitsThatLookAtLessLearnAsMuch) {
  MapperConfig config = config_for_test();
  config.schedule.prune_interval = 25;
  config.schedule.prune_opacity = 0.2;  // some go while keyframes remember what they see
  const SE3 between = translated(0.15, 0.03, 0.02);
  const auto view = wall_frame(small_camera(), between, 0, 1.2);
  const auto quality = [&](int look_interval, std::size_t& size) {
    config.schedule.look_interval = look_interval;
    const auto mapper = trained(config, nullptr, 20);
    // From now on another wall hides the first one.
    for (int i = 5; i < 10; ++i) {
      const SE3 T = translated(0.1 * (i - 5), 0.02 * (i - 5), 0);
      mapper->add_keyframe(wall_frame(small_camera(), T, i, 1.2), T);
      mapper->iterate(20);
    }
    size = mapper->size();
    return psnr_db(*mapper->snapshot(), *view, between);
  };
  std::size_t size_all = 0, size_some = 0;
  const double all = quality(1, size_all), some = quality(8, size_some);
  EXPECT_NE(some, all);
  EXPECT_GT(some, all - 1);
  EXPECT_NEAR(static_cast<double>(size_some), static_cast<double>(size_all),
              0.1 * static_cast<double>(size_all));
}

/// How the depth camera is known behind keyframe `i` of the walk; null = as before.
history::CalibrationPtr calibration_behind(int i) {
  if (i % 8 != 5) return nullptr;
  const int times = i / 8;
  DepthCalibration c;
  c.camera = small_camera();
  c.grid = {4, 3};
  c.sigma_per_m.assign(12, 1e-4);
  for (int k = 0; k < 12; ++k) c.offset_per_m.push_back(1e-3 * times * (k % 4) - 2e-3);
  c.shift_px = {0.3 * times, -0.2};
  return std::make_shared<const DepthCalibration>(c);
}

std::shared_ptr<history::ViewStore> views_within(std::size_t budget_bytes) {
  return std::make_shared<history::ViewStore>(budget_bytes, history::ViewStore::Options{});
}

// Grey views of a finished map hold what it showed, while another place is learned.
TEST(Mapper, GoesOnWithAMapAndForgetsNothingOfIt) {
  const auto first = trained(config_for_test(), nullptr, 60)->snapshot();
  std::vector<KnownKeyframe> views;
  std::vector<std::int32_t> view_of;
  for (int i = 0; i < 5; ++i) {
    const SE3 T = translated(0.1 * i, 0.02 * i, 0);
    RgbdFrame grey = *wall_frame(small_camera(), T);
    for (std::size_t k = 0; k < grey.color.size(); ++k) {
      Rgb8& c = grey.color.data()[k];
      c.r = c.g = c.b = static_cast<std::uint8_t>(std::lround(luma(c)));
    }
    grey.index = i - 100;
    views.push_back({std::make_shared<history::StoredView>(grey), Vector6d::Zero(), T, T});
  }
  for (const map::Anchor& anchor : first->anchors) view_of.push_back(anchor.keyframe);
  Mapper mapper(config_for_test(), small_camera(), 3, nullptr);
  mapper.know(first->gaussians, view_of, views);
  const auto begun = mapper.snapshot();
  ASSERT_EQ(begun->gaussians.size(), first->gaussians.size());
  EXPECT_EQ(begun->keyframe_frames.front(), -100);
  for (std::size_t i = 0; i < begun->gaussians.size(); ++i) {
    EXPECT_EQ(begun->anchors[i].id, i);
    EXPECT_EQ(begun->gaussians[i].mean[0], first->gaussians[i].mean[0]);
  }
  const SE3 T_old = views[2].T_world_camera, T_new = translated(1.6, 0, 0);
  const auto old = wall_frame(small_camera(), T_old), fresh = wall_frame(small_camera(), T_new, 1);
  const double before = psnr_db(*begun, *old, T_old);
  EXPECT_EQ(mapper.add_keyframe(fresh, T_new), 5);
  mapper.iterate(120);
  EXPECT_GT(mapper.size(), first->gaussians.size());
  EXPECT_GT(before, 38);
  EXPECT_GT(psnr_db(*mapper.snapshot(), *old, T_old), 38);
  EXPECT_GT(psnr_db(*mapper.snapshot(), *fresh, T_new), 20);
  // What hangs on a view moves with it.
  const float x = mapper.snapshot()->gaussians.front().mean[0];
  std::vector<SE3> moves(6);
  moves[static_cast<std::size_t>(view_of.front())] = translated(0.5, 0, 0);
  mapper.move_keyframes(moves);
  EXPECT_NEAR(mapper.snapshot()->gaussians.front().mean[0], x + 0.5, 1e-5);
}

// Nothing but time depends on where the pictures lie.
TEST(Mapper, MemoryHasNoEffectOnTheMap) {
  const auto map_with = [](std::size_t budget_bytes) {
    MapperConfig config = config_for_test();
    config.schedule.half_resolution_share = 0.7;
    config.schedule.most_keyframes = 100;
    const auto views = views_within(budget_bytes);
    Mapper mapper(config, small_camera(), 3, nullptr, views);
    for (int i = 0; i < 150; ++i) {
      const SE3 T = translated(0.01 * (i % 40), 0.002 * (i % 40), 0);
      mapper.add_keyframe(wall_frame(small_camera(), T, i), T);
      mapper.iterate(2);
    }
    EXPECT_EQ(views->reads() > 0, budget_bytes == 1);
    return mapper.snapshot()->gaussians;
  };
  const auto expected = map_with(std::size_t{1} << 30), actual = map_with(1);
  ASSERT_EQ(actual.size(), expected.size());
  EXPECT_EQ(std::memcmp(actual.data(), expected.data(), actual.size() * sizeof(map::Gaussian)), 0);
}

// What the disk has not kept is not learned from.
TEST(Mapper, GoesOnWithoutTheViewsThatAreGone) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "lost views";
  std::filesystem::create_directories(folder);
  const auto views = std::make_shared<history::ViewStore>(
      1, history::ViewStore::Options{.least_in_memory = 2, .folder = folder});
  Mapper mapper(config_for_test(), small_camera(), 3, nullptr, views);
  for (int i = 0; i < 6; ++i) {
    const SE3 T = translated(0.1 * i, 0.02 * i, 0);
    mapper.add_keyframe(wall_frame(small_camera(), T, i), T);
  }
  views->settle();
  ASSERT_TRUE(history::empty_spill_file_in(folder));
  mapper.change_depth(calibration_behind(5));  // so that every view is read again
  mapper.iterate(60);
  EXPECT_GE(mapper.iterations(), 30);
  EXPECT_EQ(mapper.snapshot()->T_world_keyframe.size(), 6u) << "no pose is lost";
  const auto frame = wall_frame(small_camera(), translated(0.5, 0.1, 0), 5);
  EXPECT_GT(psnr_db(*mapper.snapshot(), *frame, translated(0.5, 0.1, 0)), 15);
}

TEST(Mapper, TrainingViewsLeaveOutWhatTheyAreTold) {
  MapperConfig all = config_for_test();
  all.schedule.min_transmittance = 1e-4;
  all.schedule.min_weight = 0;
  MapperConfig shallow = all, strong = all;
  shallow.schedule.min_transmittance = 0.2;
  strong.schedule.min_weight = 0.2;
  const auto expected = trained(all, nullptr, 10)->snapshot();
  for (const MapperConfig& config : {shallow, strong}) {
    const auto actual = trained(config, nullptr, 10)->snapshot();
    const bool same = actual->gaussians.size() == expected->gaussians.size() &&
                      std::memcmp(actual->gaussians.data(), expected->gaussians.data(),
                                  actual->gaussians.size() * sizeof(map::Gaussian)) == 0;
    EXPECT_FALSE(same);
  }
}

TEST(Mapper, TrainingExplainsThePictures) {
  MapperConfig config = config_for_test();
  config.refinement.pose = false;
  config.first_keyframe_iterations = 0;
  const auto untrained = trained(config, nullptr, 0), mapper = trained(config, nullptr, 40);
  const SE3 between = translated(0.15, 0.03, 0.02);  // a view that was never trained
  const auto view = wall_frame(small_camera(), between);
  const double before = psnr_db(*untrained->snapshot(), *view, between);
  const double after = psnr_db(*mapper->snapshot(), *view, between);
  EXPECT_GT(after, 30.0);
  EXPECT_GT(after, before + 2);
  EXPECT_EQ(mapper->iterations(), 200);
}

TEST(Mapper, SpendsStepsOnTheFirstKeyframeOnly) {
  MapperConfig config = config_for_test();
  config.first_keyframe_iterations = 7;
  EXPECT_EQ(trained(config, nullptr, 0)->iterations(), 7);
}

TEST(Mapper, GivesTheSameBitsForAnyNumberOfThreads) {
  ThreadPool two(2), three(3);
  const auto a = trained(config_for_test(), nullptr, 12)->snapshot();
  for (ThreadPool* pool : {&two, &three}) {
    const auto b = trained(config_for_test(), pool, 12)->snapshot();
    ASSERT_EQ(a->gaussians.size(), b->gaussians.size());
    EXPECT_EQ(std::memcmp(a->gaussians.data(), b->gaussians.data(),
                          a->gaussians.size() * sizeof(map::Gaussian)),
              0);
  }
}

TEST(Mapper, PaperRecipeTrainsToo) {
  MapperConfig config = paper_mapper_config();
  config.insertion.grid_step_px = 10;
  Mapper mapper(config, small_camera(), 1, nullptr);
  const auto frame = wall_frame(small_camera(), SE3{});
  mapper.add_keyframe(frame, SE3{});
  mapper.iterate(3);
  const double before = psnr_db(*mapper.snapshot(), *frame, SE3{});
  mapper.iterate(60);
  EXPECT_GT(psnr_db(*mapper.snapshot(), *frame, SE3{}), before + 1);
}

TEST(Mapper, RefusesFramesThatCannotBeMapped) {
  Mapper mapper(config_for_test(), small_camera(), 1, nullptr);
  auto blind = wall_frame(small_camera(), SE3{});
  blind->depth.fill(0);
  EXPECT_EQ(mapper.add_keyframe(blind, SE3{}), -1);
  SE3 nowhere;
  nowhere.t.x() = std::nan("");
  EXPECT_EQ(mapper.add_keyframe(wall_frame(small_camera(), SE3{}), nowhere), -1);
  EXPECT_EQ(mapper.iterate(5).iterations, 0);
  EXPECT_TRUE(mapper.snapshot()->gaussians.empty());
  EXPECT_EQ(mapper.add_keyframe(wall_frame(small_camera(), SE3{}), SE3{}), 0);
}

TEST(Mapper, SnapshotsDoNotChange) {
  const auto mapper = trained(config_for_test(), nullptr, 4);
  const auto before = mapper->snapshot();
  EXPECT_EQ(mapper->snapshot(), before);
  const auto copy = before->gaussians;
  mapper->iterate(3);
  EXPECT_NE(mapper->snapshot(), before);
  EXPECT_EQ(std::memcmp(copy.data(), before->gaussians.data(), copy.size() * sizeof(copy[0])), 0);
  EXPECT_EQ(before->anchors.size(), before->gaussians.size());
  EXPECT_EQ(before->T_world_keyframe.size(), 5u);
}

TEST(Mapper, PullsAMisplacedKeyframeBack) {
  Mapper mapper(config_for_test(), small_camera(), 3, nullptr);
  for (int i = 0; i < 4; ++i) {
    const SE3 T = translated(0.1 * i, 0, 0);
    mapper.add_keyframe(wall_frame(small_camera(), T, i), T);
    mapper.iterate(30);
  }
  const SE3 truth = translated(0.2, 0.05, 0);
  mapper.add_keyframe(wall_frame(small_camera(), truth, 4), translated(0.215, 0.04, 0.0));
  mapper.iterate(300);
  const SE3 refined = mapper.snapshot()->T_world_keyframe.back();
  EXPECT_LT((refined.t - truth.t).head<2>().norm(), 0.009) << refined.t.transpose();
}

TEST(Mapper, MergesWhatAMoveLaysOnItself) {
  const auto size = [](bool merge) {
    MapperConfig config = config_for_test();
    config.merge.enabled = merge;
    Mapper mapper(config, small_camera(), 3, nullptr);
    // The same view twice, the second time held to be 20 cm nearer, until that is mended.
    mapper.add_keyframe(wall_frame(small_camera(), SE3{}, 0), SE3{});
    mapper.add_keyframe(wall_frame(small_camera(), SE3{}, 1), translated(0, 0, -0.2));
    mapper.iterate(20);
    mapper.move_keyframes({SE3{}, translated(0, 0, 0.2)});
    mapper.iterate(20);  // goes on from there
    return mapper.size();
  };
  EXPECT_LT(static_cast<double>(size(true)), 0.8 * static_cast<double>(size(false)));
}

TEST(Mapper, IsPulledTowardsTheTrackedPoseNotTheOneItBeganWith) {
  MapperConfig config = config_for_test();
  config.refinement.pose_prior_rotation = config.refinement.pose_prior_translation = 1e4;
  Mapper mapper(config, small_camera(), 3, nullptr);
  mapper.add_keyframe(wall_frame(small_camera(), SE3{}), SE3{});
  mapper.iterate(30);
  const SE3 truth = translated(0.1, 0, 0), begun = translated(0.11, 0.01, 0);
  ASSERT_EQ(mapper.add_keyframe(wall_frame(small_camera(), truth, 1), begun, truth), 1);
  mapper.iterate(60);
  EXPECT_LT((mapper.snapshot()->T_world_keyframe.back().t - truth.t).norm(), 1e-3);
  SE3 nowhere;
  nowhere.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mapper.add_keyframe(wall_frame(small_camera(), truth, 2), truth, nowhere), -1);
}

TEST(Mapper, FindsTheGainOfADimmedView) {
  MapperConfig config = config_for_test();
  config.refinement.exposure_prior = 0;
  const PinholeCamera camera = small_camera();
  MapKeyframe keyframe(*wall_frame(camera, SE3{}, 0, 2.0, 0.8), SE3{}, 10);
  Mapper mapper(config, camera, 3, nullptr);
  mapper.add_keyframe(wall_frame(camera, SE3{}), SE3{});
  mapper.iterate(60);
  render::Rendering rendering;
  render::make_cpu_rasterizer(nullptr)->render(mapper.snapshot()->gaussians, camera, SE3{},
                                               rendering);
  const ExposureSums sums = exposure_sums(keyframe, rendering);
  for (int i = 0; i < 12; ++i) update_gain(keyframe, sums.measured, sums.rendered, 0, 0.5);
  for (const float gain : keyframe.gain) EXPECT_NEAR(gain, 0.8, 0.02);
  update_gain(keyframe, sums.measured, sums.rendered, 1.0, 1.0);
  for (const float gain : keyframe.gain) EXPECT_NEAR(gain, 0.9, 0.02);
}

TEST(Mapper, PrunesWhatHasFaded) {
  MapperConfig config = config_for_test();
  config.schedule.prune_interval = 1000;
  const auto kept = trained(config, nullptr, 2)->size();
  config.schedule.prune_interval = 1;
  config.schedule.prune_opacity = 0.65;  // at birth 0.7: whatever faded a little goes
  EXPECT_LT(trained(config, nullptr, 2)->size(), kept);
}

/// Keyframe `i` of a walk along the wall.
void add_keyframe_of_walk(Mapper& mapper, int i) {
  const SE3 T = translated(0.03 * (i % 20), 0.006 * (i % 20), 0);
  mapper.add_keyframe(wall_frame(small_camera(), T, 10 * i), T);
}

void walk(Mapper& mapper, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    add_keyframe_of_walk(mapper, i);
    mapper.iterate(7);
    if (const auto now = calibration_behind(i)) mapper.change_depth(now);
    if (i % 11 == 10) {
      std::vector<SE3> moves;  // two keyframes not alike, so that some Gaussians are merged
      for (int k = 0; k <= i; ++k) moves.push_back(translated(0, 0, k % 2 == 0 ? 1e-3 : 0.015));
      mapper.move_keyframes(moves);
    }
  }
}

MapperConfig config_that_uses_everything() {
  MapperConfig config = config_for_test();
  config.schedule.prune_interval = 25;
  config.schedule.prune_opacity = 0.2;
  config.schedule.look_interval = 3;
  config.schedule.half_resolution_share = 0.6;
  config.schedule.most_keyframes = 24;
  config.refinement.pose_first_visit = 2;
  return config;
}

std::string state_of(Mapper& mapper) {
  ArchiveWriter archive;
  mapper.save(archive);
  return archive.take();
}

void restore_frames(Mapper& mapper) {
  int next = 0;
  // Keyframes that were culled are not awaited; what was learned behind them is to come again.
  const auto calibrate_before = [&](int i) {
    for (; next < std::min(i, 60); ++next) {
      if (const auto now = calibration_behind(next)) mapper.restore_calibration(now);
    }
  };
  while (const auto frame = mapper.awaited_frame()) {
    const int i = static_cast<int>(*frame / 10);
    calibrate_before(i);
    const SE3 T = translated(0.03 * (i % 20), 0.006 * (i % 20), 0);
    mapper.restore_keyframe(*wall_frame(small_camera(), T, 10 * i));
  }
  calibrate_before(40);
}

TEST(Mapper, GoesOnFromASavedStateToTheBit) {
  const MapperConfig config = config_that_uses_everything();
  Mapper whole(config, small_camera(), 3, nullptr, views_within(1));
  walk(whole, 0, 40);
  const std::string state = state_of(whole);
  walk(whole, 40, 60);

  Mapper again(config, small_camera(), 99, nullptr);  // the seed is part of the state
  ArchiveReader archive(state);
  ASSERT_TRUE(again.restore(archive));
  EXPECT_TRUE(archive.complete());
  restore_frames(again);
  EXPECT_TRUE(state_of(again) == state);
  walk(again, 40, 60);
  const auto expected = whole.snapshot(), actual = again.snapshot();
  ASSERT_EQ(actual->gaussians.size(), expected->gaussians.size());
  EXPECT_EQ(std::memcmp(actual->gaussians.data(), expected->gaussians.data(),
                        actual->gaussians.size() * sizeof(map::Gaussian)),
            0);
  ASSERT_EQ(actual->T_world_keyframe.size(), expected->T_world_keyframe.size());
  for (std::size_t k = 0; k < actual->T_world_keyframe.size(); ++k) {
    EXPECT_TRUE(actual->T_world_keyframe[k].t == expected->T_world_keyframe[k].t) << k;
  }
  EXPECT_EQ(again.iterations(), whole.iterations());
}

// Whatever one wrong byte says: an error, or a state that can be gone on from.
TEST(Mapper, TakesNoDamagedState) {
  const MapperConfig config = config_that_uses_everything();
  Mapper small(config, small_camera(), 3, nullptr);
  walk(small, 0, 3);
  const std::string state = state_of(small);
  for (std::size_t size : {std::size_t{0}, state.size() / 2, state.size() - 1}) {
    Mapper mapper(config, small_camera(), 3, nullptr);
    ArchiveReader archive(std::string_view(state).substr(0, size));
    EXPECT_FALSE(mapper.restore(archive)) << size;
  }
  int refused = 0;
  for (std::size_t at = 0; at < state.size(); at += 1 + state.size() / 60) {
    std::string damaged = state;
    damaged[at] = static_cast<char>(~damaged[at]);
    Mapper mapper(config, small_camera(), 3, nullptr);
    ArchiveReader archive(damaged);
    if (!mapper.restore(archive)) {
      ++refused;
      continue;
    }
    if (mapper.awaited_frame().value_or(0) % 10 != 0) continue;
    restore_frames(mapper);
    mapper.iterate(2);
  }
  EXPECT_GT(refused, 0);
}

TEST(MapperConfig, SmallLeavesAndFullResolutionWherePixelsAreCoarse) {
  const MapperConfig usual;
  for (const double focal_px : {525.0, 600.0, 400.0}) {
    const MapperConfig same = for_focal_length(usual, focal_px);
    EXPECT_EQ(same.insertion.leaf_min_px, usual.insertion.leaf_min_px) << focal_px;
    EXPECT_EQ(same.schedule.half_resolution_share, usual.schedule.half_resolution_share);
  }
  const MapperConfig coarse = for_focal_length(usual, 300);
  EXPECT_EQ(2 * coarse.insertion.leaf_min_px, usual.insertion.leaf_min_px);
  EXPECT_EQ(coarse.schedule.half_resolution_share, 0);
  MapperConfig smallest;
  smallest.insertion.leaf_min_px = 1;
  EXPECT_EQ(for_focal_length(smallest, 300).insertion.leaf_min_px, 1);
}

}  // namespace
}  // namespace sgs::mapper
