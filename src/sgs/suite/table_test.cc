// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/table.h"

#include <gmock/gmock.h>

#include "sgs/io/temporary_folder.h"
#include "sgs/run/machine.h"
#include "sgs/suite/provenance.h"
#include "sgs/suite/slurm.h"
#include "sgs/suite/sweep.h"

namespace sgs::suite {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

eval::Metrics scores(double ate_m, int tracked = 100) {
  eval::Metrics m;
  m.frames = 100;
  m.frames_tracked = tracked;
  m.ate_rmse_m = ate_m;
  return m;
}

TEST(AteCell, IsMeanAndWorstAndTheLowestShareOfFrames) {
  EXPECT_EQ(ate_cell({}), "-");
  EXPECT_EQ(ate_cell(std::vector{eval::Metrics{}}), "-");
  EXPECT_EQ(ate_cell(std::vector{scores(0.01), scores(0.02)}), "1.50 (2.00)");
  EXPECT_EQ(ate_cell(std::vector{scores(0.01, 40), scores(0.02, 90)}), "1.50 (2.00) 40%");
}

/// Jobs of two sequences, of which the first has been run.
class Tables : public ::testing::Test {
 protected:
  Tables() {
    suite_.sequences = {{"near", "fold", "", ""}, {"far", "fold", "", ""}};
    suite_.publications = {
        {"paper, table 1", {{"Other", {{"near", 3.0}, {"far", {}}}}, {"None", {}}}},
        {"another paper", {{"Third", {{"elsewhere", 1.0}}}}}};
    options_.output = folder_.path().string();
    options_.levels = {"hard"};
    options_.seeds = {1};
  }
  std::vector<Job> jobs_with_scores_of_the_first(double ate_m) {
    const std::vector<Job> jobs = *make_jobs(suite_, options_);
    std::filesystem::create_directories(jobs[0].folder);
    EXPECT_TRUE(eval::save_metrics(jobs[0].folder / "metrics.json", scores(ate_m)));
    return jobs;
  }

  io::TemporaryFolder folder_;
  Suite suite_;
  Options options_;
};

TEST_F(Tables, OfAccuracyShowWhatIsDoneAndWhatOthersPublished) {
  options_.variants = {{"orb", {}}};
  const Grid grid = collect(
      jobs_with_scores_of_the_first(0.01),
      [](const Job& job) { return job.level + " " + job.variant; },
      [](const Job& job) { return job.sequence; });
  Table table = ate_table(grid, "errors");
  add_publications(suite_.publications, table);
  const std::string text = as_text(table);
  EXPECT_THAT(text, HasSubstr("errors\n                  near   far\n"
                              "hard orb   1.00 (1.00)     -\n"
                              "published, on the real sequences\n"
                              "Other [1]         3.00  lost\n"
                              "[1] paper, table 1\n"));
  EXPECT_THAT(text, Not(HasSubstr("another paper")));
  EXPECT_THAT(as_markdown(table), HasSubstr("errors\n\n|  | near | far |\n|---|---|---|\n"
                                            "| hard orb | 1.00 (1.00) | - |\n"
                                            "| Other [1] | 3.00 | lost |\n\n"));
  EXPECT_THAT(as_markdown(table), HasSubstr("\n- [1] paper, table 1\n"));
}

TEST_F(Tables, OfPicturesAndSpeedStandBesideWhatOthersPublished) {
  options_.variants = {{"orb", {}}};
  Publication::Row& other = suite_.publications[0].results[0];
  other.psnr_db = {{"near", 22.61}};
  other.fps = 40.0;
  auto jobs = jobs_with_scores_of_the_first(0.01);
  eval::Metrics metrics = scores(0.01);
  metrics.psnr_db = 28.4;
  metrics.fps_system = 90;
  ASSERT_TRUE(eval::save_metrics(jobs[0].folder / "metrics.json", metrics));
  const Grid grid = collect(
      jobs, [](const Job& job) { return job.variant; },
      [](const Job& job) { return job.sequence; });
  const auto tables = published_tables(grid, suite_.publications);
  ASSERT_EQ(tables.size(), 2u);  // nobody published SSIM or LPIPS
  EXPECT_THAT(tables[0].title, HasSubstr("PSNR"));
  EXPECT_THAT(tables[0].rows[0].cells, ElementsAre("28.40", "-"));
  ASSERT_EQ(tables[0].published.size(), 1u);
  EXPECT_EQ(tables[0].published[0].name, "Other [1]");
  EXPECT_THAT(tables[0].published[0].cells, ElementsAre("22.61", ""));
  EXPECT_THAT(tables[1].rows[0].cells, ElementsAre("90.0"));
  EXPECT_THAT(tables[1].published[0].cells, ElementsAre("40.00"));
  EXPECT_THAT(as_text(tables[0]), HasSubstr("real sequences"));
}

TEST_F(Tables, OfABenchmarkHaveAllColumnsAndTheMeanOfThoseThatAreWhole) {
  options_.variants = {{"orb", {}}};
  suite_.publications[0].results[0].ate_cm["average"] = 2.5;
  const std::vector<Job> jobs = jobs_with_scores_of_the_first(0.01);
  const auto grid_of = [&](std::span<const Job> some) {
    Grid grid = collect(
        some, [](const Job& job) { return job.variant; },
        [](const Job& job) { return job.sequence; });
    complete(suite_, {"near", "far"}, grid);
    return grid;
  };
  Table half = ate_table(grid_of(std::span(jobs).first(1)), "errors");
  add_publications(suite_.publications, half);
  EXPECT_THAT(half.columns, ElementsAre("near", "far", "average"));
  EXPECT_THAT(half.rows[0].cells, ElementsAre("1.00 (1.00)", "-", "-"));
  EXPECT_THAT(half.published[0].cells, ElementsAre("3.00", "lost", "2.50"));
  std::filesystem::create_directories(jobs[1].folder);
  ASSERT_TRUE(eval::save_metrics(jobs[1].folder / "metrics.json", scores(0.03)));
  const Grid whole = grid_of(jobs);
  EXPECT_EQ(ate_table(whole, "").rows[0].cells[2], "2.00 (3.00)");
  Grid filtered = whole;
  complete(suite_, {"near"}, filtered);
  EXPECT_THAT(filtered.columns, ElementsAre("near"));
}

TEST_F(Tables, OfASweepHaveARowForEachValue) {
  const auto range = parse_range("tau=1:4", 1, {{"tau", "tracker.tau"}});
  ASSERT_TRUE(range) << range.error().text();
  options_.variants = swept_variants({"paper", {"--preset", "paper"}}, *range);
  EXPECT_EQ(options_.variants[1].name, "2");
  EXPECT_THAT(options_.variants[1].arguments,
              ElementsAre("--preset", "paper", "--set", "tracker.tau=2"));
  const Grid grid = collect(
      jobs_with_scores_of_the_first(0.01), [](const Job& job) { return job.variant; },
      [](const Job& job) { return job.sequence; });
  EXPECT_EQ(as_text(ate_table(grid, "sweep")),
            "sweep\n"
            "          near  far\n"
            "1  1.00 (1.00)    -\n"
            "2            -    -\n"
            "4            -    -\n");
  EXPECT_THAT(sweep_plot(grid, "tracker.tau"), HasSubstr("<svg"));
  EXPECT_THAT(sweep_plot(Grid{}, "tracker.tau"), Not(HasSubstr("<svg")));
}

TEST_F(Tables, OfTimesNeverMixProcessors) {
  options_.variants = {{"orb", {}}};
  options_.seeds = {1, 2, 3};
  options_.filter = "near";
  const std::vector<Job> jobs = *make_jobs(suite_, options_);
  const double fps[] = {100, 50, 10};
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    eval::Metrics m = scores(0.01);
    m.fps_wall = fps[i];
    m.track_ms_p95 = 5;
    m.cpu = i < 2 ? "Fast" : "Slow";
    ASSERT_TRUE(eval::save_metrics(jobs[i].folder / "metrics.json", m));
  }
  const Grid grid = collect(
      jobs, [](const Job& job) { return job.variant; },
      [](const Job& job) { return job.sequence; });
  EXPECT_EQ(as_text(times_table(grid, "times")),
            "times\n"
            "               near\n"
            "orb, Fast  75 / 5.0\n"
            "orb, Slow  10 / 5.0\n");
  EXPECT_THAT(processors_line(grid), HasSubstr("2 on Fast, 1 on Slow"));
  EXPECT_EQ(processors_line(Grid{}), "");
}

TEST(Range, IsGeometricAndRefusesNonsense) {
  const auto range = parse_range("a.b=25:100", 2, {});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->key, "a.b");
  EXPECT_THAT(range->values,
              ElementsAre(25, ::testing::DoubleNear(35.355, 1e-3), ::testing::DoubleNear(50, 1e-9),
                          ::testing::DoubleNear(70.711, 1e-3), ::testing::DoubleNear(100, 1e-9)));
  EXPECT_THAT(parse_range("a=3:3", 1, {})->values, ElementsAre(3));
  for (const char* text : {"a", "a=1", "a=b:c", "a=0:1", "a=-1:1", "a=2:1", "=1:2", "a=1:1e999"}) {
    EXPECT_FALSE(parse_range(text, 1, {})) << text;
  }
}

TEST(Slurm, GetsAnArrayOfShardsAndAJobThatCollects) {
  const std::string script =
      slurm_script({{"/bin/sgs", "bench", "it's"}, "/work here", "out", 12, 4});
  EXPECT_THAT(script, StartsWith("#!/bin/sh\n"));
  EXPECT_THAT(script, HasSubstr("cd '/work here'\n"));
  EXPECT_THAT(script, HasSubstr("--array=0-11 --cpus-per-task=4 --requeue"));
  EXPECT_THAT(script,
              HasSubstr(R"(exec /bin/sgs bench 'it'\''s' --shard "$SLURM_ARRAY_TASK_ID/12")"));
  EXPECT_THAT(script, HasSubstr("--dependency=\"afterany:${array%%;*}\""));
  EXPECT_THAT(script, HasSubstr("--collect\n"));
  EXPECT_THAT(slurm_script({{"sgs"}, "/", "out", 5000, 2}), HasSubstr("--array=0-999 "));
}

TEST(Provenance, SaysWhatWasRunOnWhat) {
  const std::vector<std::string> words = {"sgs", "bench", "--filter", "^(a|b)-", "it's", "a=1"};
  EXPECT_EQ(shell_command(words), R"(sgs bench --filter '^(a|b)-' 'it'\''s' a=1)");
  EXPECT_EQ(run::cpu_model("processor : 0\nmodel name\t: Some CPU @ 2 GHz\nmodel name\t: Other\n"),
            "Some CPU @ 2 GHz");
  EXPECT_EQ(run::cpu_model("Hardware: x"), "unknown CPU");
  const std::string line = provenance("1.2.3 (abc)");
  EXPECT_THAT(line, StartsWith("`sgs"));
  EXPECT_THAT(line, HasSubstr(", sgs 1.2.3 (abc), "));
  EXPECT_THAT(line, ::testing::ContainsRegex(" [0-9]+ cores, 20[0-9]{2}-[0-9]{2}-[0-9]{2}$"));
}

}  // namespace
}  // namespace sgs::suite
