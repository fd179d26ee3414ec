// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/report.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/report/comparison.h"
#include "sgs/report/drawings.h"
#include "sgs/report/html.h"
#include "sgs/report/page_files.h"

namespace sgs::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

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
    slam::FrameRecord r;
    r.index = i;
    r.timestamp_s = 5 + t;
    d.estimate_time_s.push_back(t);
    d.estimate_error_m.push_back(0.01 + 0.005 * std::sin(1.7 * t));
    d.truth_m.emplace_back(2 * std::sin(0.4 * t), std::cos(0.4 * t), 1 + 0.1 * std::sin(t));
    d.estimate_m.push_back(d.truth_m.back() +
                           Eigen::Vector3d(0.03 * std::sin(2 * t), 0.04 * std::cos(t), 0.02));
    d.error_m.push_back(i == 100 ? kUnknown : 0.01 + 0.005 * std::sin(1.7 * t));
    using tracker::TrackingStatus;
    r.status = i >= 400 && i < 410 ? TrackingStatus::kLost
               : plane             ? TrackingStatus::kDegenerate
                                   : TrackingStatus::kOk;
    if (r.status == TrackingStatus::kLost) r.lost_reason = alignment::LostReason::kTooFewPoints;
    r.track_ms = 18 + 4 * std::sin(0.9 * t);
    r.iterations = 4 * i;
    r.gaussians = 20000 + 60 * i;
    r.mapping_keyframe = i % 8 == 0;
    tracker::Diagnostics& diagnostics = r.diagnostics;
    diagnostics.prior_active = plane;
    diagnostics.condition_number = plane ? 2e4 : 60 + 20 * std::sin(t);
    diagnostics.planarity = plane ? 0.95 : 0.4 + 0.1 * std::sin(t);
    diagnostics.ms_geometry = diagnostics.ms_visual = r.track_ms / 2;
    for (std::size_t k = 0; k < 6; ++k) {
      diagnostics.weights[k] = plane && k < 2 ? 0.9 : 0.05;
      diagnostics.snr[k] = plane && k < 2 ? 1 : 100;
    }
    d.frames.push_back(r);
  }
  d.snr_threshold = 5;
  d.stages = {{"track", 600, 6000, 10, 12}, {"track/visual", 600, 4000, 7, 9}};
  d.keyframes = {SE3(Eigen::Matrix3d::Identity(), {0, 1, 1})};
  map::Gaussian gaussian{};
  gaussian.opacity_logit = 2;
  d.map = eval::map_statistics({&gaussian, 1});
  d.map_points = eval::sample_points({&gaussian, 1}, 10, SE3{});
  d.condition_threshold = 1000;
  d.planarity_threshold = 0.8;
  for (int i = 0; i < 2; ++i) {
    eval::FramePictures p;
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

  d.config_toml = "[mapper]\nwindow = 8\n";
  return d;
}

TEST(Report, ShowsEverySectionWithoutOutsideAddresses) {
  const ReportData data = synthetic_data();
  const std::string html = report_html(data);
  for (const char* text :
       {"room_desk", "Trajectory", "Tracking", "Degeneracy", "Rendering against truth", "Timing",
        "Scores", "Configuration", "1.23 cm", "26.50 dB", "51234", "window = 8", "(held out)",
        "axis 6", "threshold", "too_few_points", "mapping_iterations:", "<canvas",
        "Content-Security-Policy"}) {
    EXPECT_THAT(html, HasSubstr(text));
  }
  for (const char* text :
       {"http:", "https:", "src='//", "@import", "url(", ">nan", "'nan", " nan", "inf,"}) {
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
  d.label = evil;
  const std::string html = report_html(d);
  EXPECT_THAT(html, Not(HasSubstr("<script>")));
  EXPECT_THAT(html, Not(HasSubstr("\xff")));
  EXPECT_THAT(html,
              HasSubstr("&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;&amp;&quot;\xEF\xBF\xBD"));
}

TEST(Report, ColumnsOfAnotherLengthAreRefused) {
  ReportData d;
  d.frames.resize(2);
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

TEST(Report, ScriptDataCannotEndItsElement) {
  ReportData d = synthetic_data();
  d.label = "</script><b>";
  EXPECT_THAT(report_html(d), Not(HasSubstr("</script><b>")));
}

TEST(Report, DrawingsAreFilesOfTheirOwn) {
  const io::TemporaryFolder folder;
  const ReportData data = synthetic_data();
  const auto files = save_drawings(folder.path(), all_drawings({&data, 1}));
  ASSERT_TRUE(files);
  std::vector<std::string> names;
  std::size_t values = 0;
  for (const auto& file : *files) {
    const std::string name = file.stem();
    if (name.starts_with("value_")) {
      ++values;
    } else {
      names.push_back(name);
    }
    const std::string text = *io::read_file(file);
    EXPECT_THAT(text, ::testing::StartsWith("<svg xmlns='http://www.w3.org/2000/svg' "));
    EXPECT_THAT(text, HasSubstr("<title>"));
    EXPECT_THAT(text, HasSubstr("<style>"));
  }
  EXPECT_THAT(names,
              ::testing::ElementsAre("trajectory_top", "trajectory_side", "error", "degeneracy",
                                     "weights", "signal_to_noise", "timing", "tracking_time",
                                     "map_growth", "map_opacity", "map_scale"));
  EXPECT_GT(values, 5u);
}

TEST(Report, MapPointsAreTheTwoWidestAxes) {
  map::Gaussian g{};
  g.opacity_logit = 2;
  g.mean[0] = 1;
  // Axes of 1, 30 and 10 cm; a quarter turn about z takes x to y and y to -x.
  for (int k = 0; k < 3; ++k) g.log_scale[k] = std::log(std::array{0.01f, 0.3f, 0.1f}[k]);
  g.rotation[0] = g.rotation[3] = std::sqrt(0.5f);
  map::Gaussian faint = g;
  faint.opacity_logit = -1;
  const SE3 lift(Eigen::Matrix3d::Identity(), {0, 0, 2});
  const std::vector<map::Gaussian> gaussians = {g, faint, g, g, g};
  const std::vector<eval::MapPoint> all = eval::sample_points(gaussians, 10, lift);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_TRUE(all[0].position_m.isApprox(Eigen::Vector3f(1, 0, 2)));
  EXPECT_TRUE(all[0].axes_m[0].isApprox(Eigen::Vector3f(-0.3f, 0, 0), 1e-4f));
  EXPECT_TRUE(all[0].axes_m[1].isApprox(Eigen::Vector3f(0, 0, 0.1f), 1e-4f));
  const std::vector<eval::MapPoint> one = eval::sample_points(gaussians, 1, SE3{});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_NEAR(one[0].axes_m[0].norm(), 0.6, 1e-4);  // stands for four
}

TEST(Report, UpIsWhereTheCamerasSayUnlessTheWorldHasAConvention) {
  const auto path = [](const Eigen::Vector3d& right, const Eigen::Vector3d& down) {
    Eigen::Matrix3d R;
    R << right, down, right.cross(down);
    return Trajectory({{0, SE3(R, Eigen::Vector3d::Zero())}, {1, SE3(R, {0.1, 0, 0})}});
  };
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  EXPECT_EQ(likely_up({}), -y);
  EXPECT_EQ(likely_up(path(x, y)), -y);                              // starts at the camera
  EXPECT_EQ(likely_up(path(x, -z)), z);                              // level, z up
  EXPECT_EQ(likely_up(path(x, Eigen::Vector3d(0, -0.8, -0.6))), z);  // looks steeply down
  EXPECT_EQ(likely_up(path(x, -y)), z);                              // straight down
  EXPECT_EQ(likely_up(path(Eigen::Vector3d(0.8, 0, 0.6), y)), -y);   // y down, turned
  EXPECT_EQ(likely_up(path(z, x)), -x);                              // a phone on its side
}

TEST(Report, TopViewLooksDownAlongUp) {
  for (const Eigen::Vector3d& up : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, -1, 0)}) {
    for (const Eigen::Vector3d& longest :
         {Eigen::Vector3d(3, 1, 0.5), Eigen::Vector3d(0.5, 1, 3)}) {
      ReportData d;
      d.up = up;
      d.estimate_m = {Eigen::Vector3d::Zero(), longest};
      const Views views = choose_views({&d, 1});
      EXPECT_EQ(views.up, up);
      EXPECT_EQ(views.across.cross(views.away), up);
      EXPECT_GE(std::abs(views.across.dot(longest)), std::abs(views.away.dot(longest)));
    }
  }
}

TEST(Report, ATiltedWorldIsSeenUprightAllTheSame) {
  ReportData d;
  d.up = Eigen::Vector3d(0.1, -0.8, -0.6).normalized();
  d.estimate_m = {Eigen::Vector3d::Zero(), {0.2, 1.2, -1.6}, {3, 0, 0}};
  Views views = choose_views({&d, 1});
  EXPECT_TRUE(views.up.isApprox(d.up));
  EXPECT_TRUE(views.across.cross(views.away).isApprox(d.up));
  EXPECT_GT(std::abs(views.across.x()), 0.9);  // where the path is longest
  EXPECT_EQ(views.up_name, "up [m]");
  d.up = Eigen::Vector3d(0.02, -0.99, 0.03).normalized();  // as good as an axis
  views = choose_views({&d, 1});
  EXPECT_EQ(views.up, -Eigen::Vector3d::UnitY());
}

TEST(Comparison, ShowsRunsSideBySide) {
  std::vector<ReportData> runs = {synthetic_data(), synthetic_data()};
  runs[0].label = "ours";
  runs[1].label = "baseline";
  runs[1].metrics.ate_rmse_m = 0.5;
  runs[1].config_toml = "[mapper]\nwindow = 4\n";
  const std::string html = comparison_html(runs);
  for (const char* text : {"ours", "baseline", "best'>1.23 cm", "'v'>50.00 cm", "mapper.window",
                           "Trajectories", "log scale", "run 2"}) {
    EXPECT_THAT(html, HasSubstr(text)) << text;
  }
  for (const char* text : {"http:", "https:", "src='//", "@import", "url("}) {
    EXPECT_THAT(html, Not(HasSubstr(text))) << text;
  }
  const char* out = std::getenv("SGS_COMPARISON_OUT");
  EXPECT_TRUE(out == nullptr || save_comparison(out, runs));
}

TEST(Comparison, DifferentSequencesAreNotOverlaid) {
  std::vector<ReportData> runs = {synthetic_data(), synthetic_data()};
  runs[1].title = "office";
  EXPECT_THAT(comparison_html(runs), Not(HasSubstr("<svg")));
}

TEST(Comparison, ConfigDifferences) {
  const auto differences =
      config_differences({"[a]\nx = 1\ny = \"s\" # why\n[b]\nx = 2\n", "[a]\nx = 1\ny = \"t\"\n"});
  ASSERT_EQ(differences.size(), 2u);
  EXPECT_EQ(differences[0].key, "a.y");
  EXPECT_THAT(differences[0].values, ::testing::ElementsAre("\"s\"", "\"t\""));
  EXPECT_EQ(differences[1].key, "b.x");
  EXPECT_THAT(differences[1].values, ::testing::ElementsAre("2", ""));
}

TEST(PageFiles, ModulesBecomeOneScript) {
  EXPECT_EQ(without_imports("\n"
                            "import { a } from \"./a.mjs\";\n"
                            "/** @import { T } from \"./a.mjs\" */\n"
                            "import {\n  b,\n} from \"./b.mjs\";\n"
                            "export const c = a + b;\n"
                            "  // export and import are kept here\n"
                            "export function d() {}"),
            "\nconst c = a + b;\n  // export and import are kept here\nfunction d() {}");
  const std::string html = script_html({"vec.mjs", "splats.mjs"});
  EXPECT_THAT(html, StartsWith("<script type='module'>"));
  EXPECT_THAT(html, HasSubstr("\nconst dot ="));
  EXPECT_THAT(html, Not(HasSubstr("SPDX")));
}

}  // namespace
}  // namespace sgs::report
