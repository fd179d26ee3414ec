// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/report.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "sgs/eval/html.h"
#include "sgs/eval/svg_plot.h"

namespace sgs::eval {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

ReportData synthetic_data() {
  ReportData d;
  d.title = "room_desk";
  d.subtitle = "600 frames, 640x480";
  d.facts = {{"tracker", "spectral"}, {"preset", "default"}};
  d.notes = {"ATE: rigid alignment"};
  d.metrics.ate_rmse_m = 0.0123;
  d.metrics.tracked_percent = 99.5;
  d.metrics.psnr_db = 26.5;
  d.metrics.gaussians = 51234;
  d.up = {0, 0, 1};
  for (int i = 0; i < 600; ++i) {
    const double t = i / 30.0;
    const bool plane = i > 200 && i < 320;
    d.time_s.push_back(t);
    d.truth_m.emplace_back(2 * std::sin(0.4 * t), std::cos(0.4 * t), 1 + 0.1 * std::sin(t));
    d.estimate_m.push_back(d.truth_m.back() +
                           Eigen::Vector3d(0.03 * std::sin(2 * t), 0.04 * std::cos(t), 0.02));
    d.error_m.push_back(i == 100 ? kNone : 0.01 + 0.005 * std::sin(1.7 * t));
    d.status.push_back(i >= 400 && i < 410 ? 2 : plane ? 1 : 0);
    d.track_ms.push_back(18 + 4 * std::sin(0.9 * t));
    d.iterations.push_back(4.0 * i);
    d.gaussians.push_back(20000 + 60.0 * i);
    d.fps.push_back(24 + 2 * std::cos(t));
    d.prior_active.push_back(plane);
    d.condition_number.push_back(plane ? 2e4 : 60 + 20 * std::sin(t));
    d.planarity.push_back(plane ? 0.95 : 0.4 + 0.1 * std::sin(t));
    for (std::size_t k = 0; k < 6; ++k)
      d.weights[k].push_back(plane && k >= 3 && k < 5 ? 0.9 : 0.05);
  }
  d.condition_threshold = 1000;
  d.planarity_threshold = 0.8;
  for (int i = 0; i < 2; ++i) {
    FramePictures p;
    p.index = 100 * i + 4;
    p.heldout = i == 0;
    p.psnr_full_db = 25.5;
    p.truth = p.rendering = p.error = ColorImage(320, 240);
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        p.truth(x, y) = {static_cast<std::uint8_t>(x / 2), static_cast<std::uint8_t>(y), 90};
        p.rendering(x, y) = {static_cast<std::uint8_t>(x / 2 + 5), static_cast<std::uint8_t>(y),
                             90};
      }
    }
    d.pictures.push_back(p);
  }
  d.others = {{"baseline", Metrics{}}};
  d.config_toml = "[mapper]\nwindow = 8\n";
  return d;
}

TEST(Report, ShowsEverySectionWithoutOutsideAddresses) {
  const ReportData data = synthetic_data();
  const std::string html = report_html(data);
  for (const char* text : {"room_desk", "Trajectory", "Tracking", "Degeneracy", "Pictures",
                           "Timing", "Scores", "Comparison", "Configuration", "1.23 cm", "26.50 dB",
                           "51234", "window = 8", "(held out)", "Axis 6", "threshold"}) {
    EXPECT_THAT(html, HasSubstr(text));
  }
  for (const char* text :
       {"http:", "https:", "src='//", "@import", "url(", "<script", "nan", "inf,"}) {
    EXPECT_THAT(html, Not(HasSubstr(text))) << text;
  }
  EXPECT_LT(html.size(), 3u << 20);
  // For looking at the page: SGS_REPORT_OUT=FILE keeps it.
  const char* out = std::getenv("SGS_REPORT_OUT");
  EXPECT_TRUE(out == nullptr || save_report(out, data));
}

TEST(Report, EmptyDataStillMakesAPage) {
  const std::string html = report_html({});
  EXPECT_THAT(html, HasSubstr("n/a"));
  EXPECT_THAT(html, Not(HasSubstr("<svg")));
  EXPECT_THAT(html, HasSubstr("</html>"));
}

TEST(Report, TextIsEscaped) {
  ReportData d;
  const std::string evil = "<script>alert('x')</script>&\"\xff";
  d.title = d.subtitle = d.config_toml = evil;
  d.facts = {{evil, evil}};
  d.notes = {evil};
  d.metrics.preset = evil;
  d.others = {{evil, d.metrics}};
  const std::string html = report_html(d);
  EXPECT_THAT(html, Not(HasSubstr("<script>")));
  EXPECT_THAT(html, Not(HasSubstr("\xff")));
  EXPECT_THAT(html,
              HasSubstr("&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;&amp;&quot;\xEF\xBF\xBD"));
}

TEST(Report, ColumnsOfAnotherLengthAreRefused) {
  ReportData d;
  d.time_s = {0, 1};
  d.error_m = {1};
  EXPECT_THROW(report_html(d), ContractViolation);
}

TEST(Html, Base64) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Plot, LongLinesAreThinnedButKeepTheirExtremes) {
  PlotSeries s;
  for (int i = 0; i < 100000; ++i) {
    s.x.push_back(i);
    s.y.push_back(i == 54321 ? 1000 : 0);
  }
  const std::string all = plot_svg({s}, {});
  EXPECT_LT(all.size(), 60000u);
  s.y[54321] = 0;
  EXPECT_NE(all, plot_svg({s}, {}));
}

TEST(Plot, NothingToDraw) {
  EXPECT_EQ(plot_svg({}, {}), "");
  EXPECT_EQ(plot_svg({{"", 0, {0, 1}, {kNone, kNone}, false, false}}, {}), "");
  PlotOptions log;
  log.log_y = true;
  EXPECT_EQ(plot_svg({{"", 0, {0, 1}, {0, -1}, false, false}}, log), "");
  EXPECT_THAT(plot_svg({{"", 0, {1}, {5}, false, false}}, {}), Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace sgs::eval
