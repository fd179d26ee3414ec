// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/metrics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "sgs/eval/run_evaluator.h"
#include "sgs/eval/trajectory_metrics.h"

namespace sgs::eval {
namespace {

using ::testing::HasSubstr;

TEST(Metrics, EmptyOnesAreNullUnderEveryKey) {
  const std::string json = to_json({});
  for (const char* key : {"frames",
                          "frames_tracked",
                          "frames_lost",
                          "tracked_percent",
                          "ate_rmse_m",
                          "ate_mean_m",
                          "ate_median_m",
                          "ate_max_m",
                          "rpe_trans_1s_m",
                          "rpe_rot_1s_deg",
                          "psnr_db",
                          "ssim",
                          "lpips",
                          "psnr_db_full",
                          "ssim_full",
                          "lpips_full",
                          "psnr_db_heldout",
                          "ssim_heldout",
                          "lpips_heldout",
                          "depth_l1_m",
                          "gaussians",
                          "map_bytes",
                          "keyframes",
                          "mapping_iterations",
                          "fps_system",
                          "fps_wall",
                          "track_ms_p50",
                          "track_ms_p95",
                          "map_iteration_ms_p50",
                          "peak_rss_bytes",
                          "degenerate_percent",
                          "prior_percent",
                          "frames_dropped",
                          "seed",
                          "threads",
                          "preset",
                          "tracker",
                          "version"}) {
    EXPECT_THAT(json, HasSubstr(fmt::format("\"{}\": null", key)));
  }
  EXPECT_EQ(std::count(json.begin(), json.end(), ':'), 38);
  EXPECT_EQ(*metrics_from_json(json, "test"), Metrics{});
}

TEST(Metrics, RoundTrip) {
  Metrics m;
  m.frames = 600;
  m.ate_rmse_m = 0.1 + 0.2;
  m.peak_rss_bytes = 3'000'000'000'000;
  m.seed = 0;
  m.preset = "de\"fault";
  EXPECT_EQ(*metrics_from_json(to_json(m), "test"), m);
  m.ssim = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(to_json(m), HasSubstr("\"ssim\": null"));
}

TEST(Metrics, BadFilesAreErrorsThatNameTheKey) {
  EXPECT_FALSE(metrics_from_json("{", "m.json"));
  EXPECT_FALSE(metrics_from_json("[1]", "m.json"));
  const auto wrong = metrics_from_json(R"({"ssim": "high"})", "m.json");
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("ssim"));
  EXPECT_FALSE(metrics_from_json(R"({"frames": 1.5})", "m.json"));
  EXPECT_TRUE(metrics_from_json(R"({"later": 1, "ssim": 1})", "m.json"));
}

TEST(Metrics, TakesOverWhatWasMeasured) {
  TrajectoryMetrics t;
  t.ate = ErrorStatistics{4, 3, 2, 1, 0, 9};
  t.rpe_1s = RelativeError{0.5, 0.25, 10};
  Metrics m;
  m.rpe_rot_1s_deg = 99;
  m.set(t);
  EXPECT_EQ(m.ate_rmse_m, 4);
  EXPECT_EQ(m.ate_max_m, 9);
  EXPECT_EQ(m.rpe_rot_1s_deg, 0.25);
  EXPECT_FALSE(m.tracked_percent);
  RunEvaluation r;
  r.gsicp.psnr_db = 24;
  r.heldout.lpips = 0.2;
  m.set(r);
  EXPECT_EQ(m.psnr_db, 24);
  EXPECT_EQ(m.lpips_heldout, 0.2);
  EXPECT_FALSE(m.psnr_db_full);
}

TEST(Metrics, Tables) {
  Metrics m;
  m.ate_rmse_m = 0.0234;
  EXPECT_THAT(metrics_table(m), HasSubstr("2.34 cm"));
  EXPECT_THAT(metrics_table(m), HasSubstr("n/a"));
  const std::vector<std::pair<std::string, Metrics>> runs = {{"ours", m}, {"baseline", {}}};
  const std::string table = comparison_table(runs);
  EXPECT_THAT(table, HasSubstr("ours"));
  EXPECT_THAT(table, HasSubstr("baseline"));
  const std::size_t width = table.find('\n');
  for (std::size_t at = 0; at < table.size(); at = table.find('\n', at) + 1) {
    EXPECT_EQ(table.find('\n', at) - at, width);
  }
  EXPECT_EQ(comparison_table({}), "");
}

}  // namespace
}  // namespace sgs::eval
