// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/metrics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>

namespace sgs::eval {
namespace {

using ::testing::HasSubstr;

TEST(Metrics, EmptyOnesAreNullUnderEveryKey) {
  const std::string json = to_json({});
  int keys = 0;
  visit_metrics(Metrics{}, [&](const MetricInfo& info, const auto&) {
    EXPECT_THAT(json, HasSubstr(fmt::format("\"{}\": null", info.key)));
    ++keys;
  });
  EXPECT_EQ(std::count(json.begin(), json.end(), ':'), keys);
  EXPECT_EQ(*metrics_from_json(json, "test"), Metrics{});
}

// A field that is missing in visit_metrics() would be lost on the way through the file.
TEST(Metrics, EveryFieldIsDeclared) {
  std::size_t bytes = 0;
  visit_metrics(Metrics{}, [&](const MetricInfo&, const auto& field) { bytes += sizeof(field); });
  EXPECT_EQ(bytes, sizeof(Metrics));
}

TEST(Metrics, DeclarationsAreWhole) {
  std::set<std::string_view> keys, labels, groups;
  std::string_view group;
  visit_metrics(Metrics{}, [&](const MetricInfo& info, const auto&) {
    EXPECT_TRUE(keys.insert(info.key).second) << info.key;
    EXPECT_TRUE(labels.insert(info.label).second) << info.label;
    EXPECT_TRUE(info.meaning.ends_with(".")) << info.key;
    if (info.group != group) {
      EXPECT_TRUE(groups.insert(info.group).second) << "split: " << info.key;
    }
    group = info.group;
  });
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

// Whoever reads a run folder reads what somebody else wrote into it.
TEST(Metrics, ValuesOfEndlessDepthAreRefused) {
  constexpr std::size_t kDeep = 200'000;
  const std::string deep = std::string(kDeep, '[') + std::string(kDeep, ']');
  EXPECT_FALSE(metrics_from_json(R"({"ssim": )" + deep + "}", "m.json"));
  (void)metrics_from_json(R"({"later": )" + deep + "}", "m.json");  // ends, whatever it says
}

TEST(Metrics, AnEvaluationReplacesItsGroupAsAWhole) {
  Metrics m;
  m.rpe_rot_1s_deg = 99;
  m.psnr_db = 20;
  Metrics measured;
  measured.ate_rmse_m = 4;
  measured.psnr_db = 30;
  replace_group(m, kTrajectoryGroup, measured);
  EXPECT_EQ(m.ate_rmse_m, 4);
  EXPECT_FALSE(m.rpe_rot_1s_deg);
  EXPECT_EQ(m.psnr_db, 20);
}

TEST(Metrics, BestRuns) {
  std::vector<Metrics> runs(3);
  EXPECT_TRUE(best_runs("ate_rmse_m", runs).empty());
  runs[0].ate_rmse_m = 0.02;
  EXPECT_TRUE(best_runs("ate_rmse_m", runs).empty()) << "nothing to compare with";
  runs[1].ate_rmse_m = 0.01;
  runs[2].ate_rmse_m = 0.010004;  // reads the same
  EXPECT_THAT(best_runs("ate_rmse_m", runs), ::testing::ElementsAre(1, 2));
  runs[0].psnr_db = 20;
  runs[1].psnr_db = 30;
  EXPECT_THAT(best_runs("psnr_db", runs), ::testing::ElementsAre(1));
  runs[0].gaussians = 1;
  runs[1].gaussians = 2;
  EXPECT_TRUE(best_runs("gaussians", runs).empty()) << "more is neither better nor worse";
}

TEST(Metrics, MarkdownHasEveryKey) {
  const std::string table = metrics_markdown();
  visit_metrics(Metrics{}, [&](const MetricInfo& info, const auto&) {
    EXPECT_THAT(table, HasSubstr(fmt::format("| `{}` |", info.key)));
  });
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
