// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/plot/plot.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "sgs/core/error.h"
#include "sgs/report/plot/bars.h"
#include "sgs/report/plot/canvas.h"
#include "sgs/report/plot/path.h"
#include "sgs/report/plot/scale.h"

namespace sgs::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

PlotFigure figure_of(const PlotSeries& series, bool log_y = false) {
  PlotPanel panel;
  panel.series = {series};
  panel.log_y = log_y;
  PlotFigure figure;
  figure.title = "a <title>";
  figure.panels = {panel};
  return figure;
}

TEST(Plot, LongLinesAreThinnedButKeepTheirExtremes) {
  PlotSeries s;
  for (int i = 0; i < 100000; ++i) {
    s.x.push_back(i);
    s.y.push_back(i == 54321 ? 1000 : 0);
  }
  const std::string all = figure_svg(figure_of(s));
  EXPECT_LT(all.size(), 60000u);
  s.y[54321] = 0;
  EXPECT_NE(all, figure_svg(figure_of(s)));
}

TEST(Plot, NothingToDraw) {
  EXPECT_EQ(figure_svg({}), "");
  EXPECT_EQ(figure_svg(figure_of({"", 0, {0, 1}, {kNone, kNone}, false, false})), "");
  EXPECT_EQ(figure_svg(figure_of({"", 0, {0, 1}, {0, -1}, false, false}, true)), "");
  const std::string one = figure_svg(figure_of({"", 0, {1}, {5}, false, false}));
  EXPECT_THAT(one, Not(HasSubstr("nan")));
  EXPECT_THAT(one, HasSubstr("<title>a &lt;title&gt;</title>"));
}

TEST(Plot, PanelsWithoutDataAreLeftOut) {
  PlotFigure figure = figure_of({"", 0, {0, 1}, {0, 1}, false, false});
  const std::string alone = figure_svg(figure);
  figure.panels.push_back({});
  PlotPanel empty_rows;
  empty_rows.rows = {{"x", {0, 1}, {kNone, kNone}, {}}};
  figure.panels.push_back(empty_rows);
  EXPECT_EQ(figure_svg(figure), alone);
}

TEST(Plot, RowsJoinEqualNeighboursAndLeaveGaps) {
  PlotPanel panel;
  panel.rows = {{"row", {0, 1, 2, 3, 4, 5}, {1, 1, 1, 0, kNone, 1}, {"off", "on"}}};
  PlotFigure figure;
  figure.panels = {panel};
  const std::string svg = figure_svg(figure);
  std::size_t rectangles = 0;
  for (auto at = svg.find("<rect class='bar"); at != std::string::npos;
       at = svg.find("<rect class='bar", at + 1)) {
    ++rectangles;
  }
  EXPECT_EQ(rectangles, 3u);
}

TEST(Plot, StackReachesTheSum) {
  PlotPanel panel;
  panel.stacked = true;
  panel.series = {{"a", 0, {0, 1, 2}, {1, 1, 1}, false, false},
                  {"b", 1, {0, 1, 2}, {2, kNone, 2}, false, false}};
  panel.height = 100;
  PlotFigure figure;
  figure.panels = {panel};
  const std::string svg = figure_svg(figure);
  // 3 of 3.18 from the bottom at 110: the top of the second area.
  EXPECT_THAT(svg, HasSubstr(fmt::format("M66.0 {:.1f}", 110 - 100 * 3 / 3.18)));
}

TEST(Plane, ColoursFollowTheValue) {
  PlaneFigure figure;
  figure.paths = {{"p", 0, {0, 1, 2, 3}, {0, 1, 0, 1}, {0, 0, 10, 10}, false, true}};
  figure.value_max = 10;
  figure.value_label = "error";
  const std::string svg = plane_svg(figure);
  EXPECT_THAT(svg, HasSubstr("line h0 heavy"));
  EXPECT_THAT(svg, HasSubstr("line h8 heavy"));
  EXPECT_THAT(svg, HasSubstr(">error<"));
  EXPECT_EQ(plane_svg({}), "");
}

TEST(Plane, OneMetreIsAsLongBothWays) {
  PlaneFigure figure;
  figure.paths = {{"", 0, {0, 1, 1}, {0, 0, 1}, {}, false, false}};
  const std::string svg = plane_svg(figure);
  const auto at = svg.find("<path class='line c0' d='M");
  ASSERT_NE(at, std::string::npos);
  double u[3], v[3];
  ASSERT_EQ(std::sscanf(svg.c_str() + at, "<path class='line c0' d='M%lf %lfh0L%lf %lfL%lf %lf",
                        &u[0], &v[0], &u[1], &v[1], &u[2], &v[2]),
            6);
  EXPECT_NEAR(u[1] - u[0], v[1] - v[2], 0.15);
  EXPECT_GT(u[1] - u[0], 100);
}

TEST(Bars, HistogramCountsEverythingOnce) {
  eval::Histogram h(0, 1, 4);
  for (const double v : {-5.0, 0.1, 0.3, 0.99, 7.0, kNone}) h.add(v);
  EXPECT_THAT(h.counts, ::testing::ElementsAre(2, 1, 0, 2));
  EXPECT_EQ(h.total(), 5);
  EXPECT_THROW(eval::Histogram(1, 1, 4), ContractViolation);
  EXPECT_EQ(histogram_svg("t", "x", {{"", 0, eval::Histogram(0, 1, 4)}}, false), "");
  EXPECT_THAT(histogram_svg("t", "x", {{"", 0, h}}, false), HasSubstr("<path class='area c0'"));
}

TEST(Bars, Bars) {
  EXPECT_EQ(bars_svg("t", "x", {}), "");
  EXPECT_THAT(bars_svg("t", "x", {{"a", 0, 0, "0 ms", 0, false}}), Not(HasSubstr("nan")));
}

TEST(Scale, Ticks) {
  const auto texts = [](const std::vector<Tick>& ticks) {
    std::string all;
    for (const Tick& t : ticks) all += t.text + " ";
    return all;
  };
  EXPECT_EQ(texts(linear_ticks({0, 1}, 5)), "0.0 0.2 0.4 0.6 0.8 1.0 ");
  EXPECT_EQ(texts(linear_ticks({-30000, 30000}, 3)), "-20k 0 20k ");
  EXPECT_EQ(texts(log_ticks({-1.2, 2.1})), "0.1 1 10 100 ");
  EXPECT_TRUE(linear_ticks({}, 5).empty());
  EXPECT_EQ(short_number(0.012345), "0.0123");
  EXPECT_EQ(short_number(1234), "1234");
  EXPECT_EQ(short_number(23456), "23.5k");
  EXPECT_EQ(short_number(kNone), "n/a");
}

TEST(Canvas, HeatSteps) {
  EXPECT_EQ(heat_step(-1), 0);
  EXPECT_EQ(heat_step(0.5), 4);
  EXPECT_EQ(heat_step(1), 8);
  EXPECT_EQ(heat_step(3), 8);
  EXPECT_THROW(standalone_svg({}), ContractViolation);
}

TEST(Canvas, FilesNeedNoCustomProperties) {
  const std::string file = standalone_svg({"name", "", "<svg viewBox='0 0 1 1'><g/></svg>"});
  EXPECT_EQ(file.find("var("), std::string::npos);
  EXPECT_NE(file.find("color: #0072b2;"), std::string::npos) << "light blue";
  EXPECT_EQ(file.find("#56b4e9"), std::string::npos) << "dark blue";
}

}  // namespace
}  // namespace sgs::report
