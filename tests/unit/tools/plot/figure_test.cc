#include "tools/plot/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/gnuplot_script.h"
#include "tools/plot/legend.h"
#include "tools/plot/plane_figure.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

// The trace of a squat.
Columns squat_trace() {
  Columns trace = make_columns({"time_s", "base_z_m", "knee_target_rad", "knee_rad"});
  for (int i = 0; i <= 2000; ++i) {
    const double time_s = 0.01 * i;
    const double target = time_s < 4.0 ? 0.0 : 0.6 - 0.6 * std::cos(std::numbers::pi * (time_s - 4.0) / 2.0);
    const double actual = target - 0.02 * std::sin(target) + 0.003 * std::sin(40.0 * time_s);
    add_row(trace, {time_s, 0.17 + 0.065 * (2.0 * std::cos(0.5 * actual) - 2.0), target, actual});
  }
  return trace;
}

Figure squat_figure() {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  Figure figure;
  figure.title = "Squat: 'base' height and left_knee";
  figure.panels.push_back(
      {.y_label = "base height [mm]", .series = {{.column = "base_z_m", .label = "base", .factor = 1000.0}}});
  figure.panels.push_back({.y_label = "left knee [°]",
                           .series = {{.column = "knee_rad", .label = "actual", .factor = kDegrees},
                                      {.column = "knee_target_rad",
                                       .label = "target",
                                       .style = LineStyle::kDashed,
                                       .factor = kDegrees}}});
  figure.marks = {{1.5, "enable"}, {4.0, "play squat"}};
  return figure;
}

class Drawing : public ::testing::Test {
 protected:
  const koboshi::test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path;
  const Columns trace_ = squat_trace();
};

TEST_F(Drawing, WritesPngAndSvgOnly) {
  draw(squat_figure(), trace_, folder_ / "squat");
  EXPECT_THAT(contents(folder_ / "squat.png"), StartsWith("\x89PNG"));
  const std::string svg = contents(folder_ / "squat.svg");
  for (const char* text :
       {"base height [mm]", "left knee [°]", "time [s]", "target", "play squat", "left_knee"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "squat.gnuplot"));
}

TEST_F(Drawing, IsReproducible) {
  draw(squat_figure(), trace_, folder_ / "a");
  draw(squat_figure(), trace_, folder_ / "b");
  EXPECT_EQ(contents(folder_ / "a.png"), contents(folder_ / "b.png"));
  EXPECT_EQ(contents(folder_ / "a.svg"), contents(folder_ / "b.svg"));
}

TEST_F(Drawing, DrawsConstantAndMissingData) {
  const Columns columns{{"time_s", {0, 1, 2}}, {"constant", {5, 5, 5}}, {"missing", {NAN, NAN, NAN}}};
  Figure figure;
  figure.panels = {{.y_label = "c", .series = {{.column = "constant"}}},
                   {.y_label = "m", .series = {{.column = "missing"}}}};
  EXPECT_NO_THROW(draw(figure, columns, folder_ / "flat"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "flat.png"));
}

TEST_F(Drawing, ShowsPathsOverTheGroundWithEqualAxes) {
  const PlaneFigure figure{
      .title = "path",
      .x_label = "x [mm]",
      .y_label = "y [mm]",
      .outlines = {{.corners = {{0, 0}, {400, 0}, {400, 100}, {0, 100}}, .word = "left"}},
      .curves = {{"measured", {{10, 10}, {NAN, NAN}, {390, 90}}}}};
  draw(figure, folder_ / "path");
  EXPECT_THAT(contents(folder_ / "path.png"), StartsWith("\x89PNG"));
  const std::string svg = contents(folder_ / "path.svg");
  for (const char* text : {"x [mm]", "y [mm]", "left", "measured"}) EXPECT_THAT(svg, HasSubstr(text));
  // The plane is 885 pixels wide for 432 mm, margins included, and so 270 high for 132 mm, and 126 more.
  EXPECT_THAT(svg, HasSubstr("width=\"1000\" height=\"396\""));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "path.gnuplot"));
}

TEST_F(Drawing, DrawsUnicodeInAnyLocale) {
  const char* const before = getenv("LC_ALL");
  const std::string kept = before != nullptr ? before : "";
  setenv("LC_ALL", "C", 1);
  testing::internal::CaptureStderr();
  draw(squat_figure(), trace_, folder_ / "squat");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  before != nullptr ? setenv("LC_ALL", kept.c_str(), 1) : unsetenv("LC_ALL");
}

TEST_F(Drawing, RejectsAMissingColumnAndWritesNothing) {
  Figure figure = squat_figure();
  figure.panels[0].series[0].column = "tail_m";
  EXPECT_THROW(draw(figure, trace_, folder_ / "squat"), PlotError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "squat.gnuplot"));
}

TEST_F(Drawing, ReportsAMissingGnuplot) {
  const std::string path = getenv("PATH");
  setenv("PATH", folder_.c_str(), 1);
  std::string message;
  try {
    draw(squat_figure(), trace_, folder_ / "squat");
  } catch (const PlotError& error) {
    message = error.what();
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("gnuplot is not installed"));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
}

TEST_F(Drawing, ReportsAFailureOfGnuplot) {
  std::ofstream(folder_ / "gnuplot") << "#!/bin/sh\nexit 3\n";
  std::filesystem::permissions(folder_ / "gnuplot", std::filesystem::perms::owner_all);
  const std::string path = getenv("PATH");
  setenv("PATH", (folder_.string() + ":" + path).c_str(), 1);
  EXPECT_THROW(draw(squat_figure(), trace_, folder_ / "squat"), PlotError);
  setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "squat.gnuplot")) << "the script stays, to be looked at";
}

TEST(GnuplotScript, ShowsTheRequestedInterval) {
  Figure figure;
  figure.panels = {{.y_label = "y", .series = {{.column = "y"}}}};
  figure.x_span = {1.0, 2.0};
  const Columns columns{{"time_s", {0.0, 1.0, 2.0, 3.0}}, {"y", {900.0, 1.0, 2.0, 900.0}}};
  const std::string script = gnuplot_script(figure, columns);
  EXPECT_THAT(script, HasSubstr("set xrange [1:2]"));
  EXPECT_THAT(script, Not(HasSubstr("900")));
}

// From the top of the page, as shares of its height: of the first page's labels of these marks.
std::vector<double> label_heights(const std::vector<Mark>& marks) {
  Figure figure{
      .title = "A title", .panels = {{.y_label = "y", .series = {{.column = "y"}}}}, .marks = marks};
  const Columns columns{{"time_s", {0.0, 100.0}}, {"y", {0.0, 1.0}}};
  const std::string script = gnuplot_script(figure, columns);
  std::vector<double> heights;
  for (const Mark& mark : marks) {
    const std::size_t label = script.find("set label '" + mark.label + "'");
    if (label != std::string::npos)
      heights.push_back(1.0 - std::stod(script.substr(script.find("screen ", label) + 7)));
  }
  return heights;
}

TEST(GnuplotScript, PlacesLabelsThatWouldCollideAboveEachOther) {
  const std::vector<double> apart = label_heights({{10, "enable"}, {50, "walk"}, {80, "stop"}});
  ASSERT_EQ(apart.size(), 3u);
  EXPECT_EQ(apart[0], apart[1]);
  EXPECT_EQ(apart[0], apart[2]);
  const std::vector<double> near =
      label_heights({{10, "enable"}, {11, "let go"}, {12, "walk"}, {98, "stop of all"}});
  ASSERT_EQ(near.size(), 4u);
  EXPECT_GT(near[0], near[1]);
  EXPECT_GT(near[1], near[2]);
  EXPECT_EQ(near[0], near[3]);
}

TEST(GnuplotScript, OmitsMarksOutsideTheAbscissa) {
  EXPECT_EQ(label_heights({{10, "enable"}, {101, "stop"}}).size(), 1u);
}

TEST(GnuplotScript, KeepsLabelsBelowTheTitle) {
  const std::vector<double> heights =
      label_heights({{10, "A"}, {10, "B"}, {10, "C"}, {10, "D"}, {10, "E"}, {10, "F"}, {10, "G"}});
  EXPECT_EQ(heights.size(), 5u);  // for more there is no room; their lines say when
  constexpr double kTitleEnd_px = 30.0;
  constexpr double kPage_px = 34.0 + 5 * 14.0 + 36.0 + 240.0 + 60.0;
  for (const double height : heights) EXPECT_GT(height * kPage_px, kTitleEnd_px);
}

// A heading that passes 180 degrees, and a quantity that is no angle.
TEST(GnuplotScript, DrawsAnglesWithoutTheJumpOfATurn) {
  const double pi = std::numbers::pi;
  const Columns columns{{"time_s", {0.0, 1.0, 2.0, 3.0, 4.0}},
                        {"yaw_rad", {3.0, 3.1, 3.2 - 2.0 * pi, std::nan(""), 3.3 - 2.0 * pi}},
                        {"yaw_N", {3.0, 3.1, -3.0, 0.0, -3.0}}};
  const Figure figure{.panels = {{.series = {{.column = "yaw_rad", .factor = 100.0}, {.column = "yaw_N"}}}}};
  const std::string script = gnuplot_script(figure, columns);
  // Without the last digits, which are rounding.
  EXPECT_THAT(script, HasSubstr("0 300\n1 310\n2 320"));
  EXPECT_THAT(script, HasSubstr("\n3 NaN\n4 330"));
  EXPECT_THAT(script, HasSubstr("0 3\n1 3.1\n2 -3\n"));
}

TEST(GnuplotScript, LeavesOutCurvesWithoutValues) {
  const Figure figure{
      .panels = {{.series = {{.column = "y", .label = "measured"}, {.column = "none", .label = "planned"}}},
                 {.series = {{.column = "none", .label = "planned"}}}}};
  const double nan = std::nan("");
  const std::string script =
      gnuplot_script(figure, {{"time_s", {0.0, 1.0}}, {"y", {0.0, 1.0}}, {"none", {nan, nan}}});
  EXPECT_THAT(script, HasSubstr("title 'measured'"));
  EXPECT_THAT(script, Not(HasSubstr("title 'planned'")));
  EXPECT_THAT(script, HasSubstr("plot NaN notitle\n"));
}

TEST(GnuplotScript, OmitsValuesBeforeTheirStart) {
  Figure figure{.panels = {{.series = {{.column = "y", .from_x = 1.0}}}}};
  const Columns columns{{"time_s", {0.0, 1.0, 2.0, 3.0}}, {"y", {-900.0, 2.0, 3.0, 2.0}}};
  const std::string script = gnuplot_script(figure, columns);
  EXPECT_THAT(script, HasSubstr("set xrange [0:3]"));
  EXPECT_THAT(script, HasSubstr("set yrange [1.95:3.05]"));
  EXPECT_THAT(script, Not(HasSubstr("900")));
}

TEST(GnuplotScript, DrawsDashedCurvesOnTop) {
  const Figure figure{
      .panels = {{.series = {series(Role::kPlanned, "y", "planned"), series(Role::kTrue, "y", "true")}}}};
  const Columns columns{{"time_s", {0.0, 1.0}}, {"y", {0.0, 1.0}}};
  const std::string script = gnuplot_script(figure, columns);
  EXPECT_LT(script.find("title 'true'"), script.find("title 'planned'"));
  EXPECT_NE(script.find("title 'planned'"), std::string::npos);
}

TEST(GnuplotScript, ShowsItsNote) {
  Figure figure{.note = "It's off by 1.8 deg.", .panels = {{.series = {{.column = "y"}}}}};
  const Columns columns{{"time_s", {0.0, 1.0}}, {"y", {0.0, 1.0}}};
  EXPECT_THAT(gnuplot_script(figure, columns), HasSubstr("set label 'It''s off by 1.8 deg.'"));
}

TEST(Legend, DistinguishesRoles) {
  const std::vector<Role> roles{Role::kPlanned, Role::kMeasured, Role::kTrue,  Role::kTheory,
                                Role::kLeft,    Role::kRight,    Role::kFirst, Role::kSecond};
  std::set<int> colours;
  for (const Role role : roles) colours.insert(colour_of(role));
  EXPECT_EQ(colours.size(), roles.size());
  EXPECT_EQ(style_of(Role::kPlanned), LineStyle::kDashed);
  EXPECT_EQ(style_of(Role::kTrue), LineStyle::kSolid);
  const Series truth = series(Role::kTrue, "true_roll_rad", "true", 57.3);
  EXPECT_EQ(palette_colour(static_cast<std::size_t>(truth.colour.value())), "#000000");
  EXPECT_EQ(planned_series(Role::kLeft, "a", "b").colour, colour_of(Role::kLeft));
}

TEST(GnuplotScript, DrawsPointsOnLogarithmicAxes) {
  const Columns columns{{"step", {0.1, 1.0}}, {"error", {1e-4, 1e-2}}};
  Figure figure{.panels = {{.series = {{.column = "error", .style = LineStyle::kLinesPoints}}}},
                .x_column = "step"};
  EXPECT_THAT(gnuplot_script(figure, columns), Not(HasSubstr("logscale")));
  figure.log_log = true;
  const std::string script = gnuplot_script(figure, columns);
  EXPECT_THAT(script, HasSubstr("set logscale xy\n"));
  EXPECT_THAT(script, HasSubstr("with linespoints"));
  // Below the smallest value, but above zero.
  const double low = std::stod(script.substr(script.find("set yrange [") + 12));
  EXPECT_GT(low, 0.0);
  EXPECT_LT(low, 1e-4);
}

TEST(GnuplotScript, KeepsASmallestSpan) {
  Figure figure;
  figure.panels = {{.y_label = "y", .series = {{.column = "y"}}, .smallest_span = 10.0}};
  const Columns columns{{"time_s", {0.0, 1.0}}, {"y", {2.0, 3.0}}};
  EXPECT_THAT(gnuplot_script(figure, columns), HasSubstr("set yrange [-3:8]"));
  figure.panels[0].smallest_span = 0.0;
  EXPECT_THAT(gnuplot_script(figure, columns), HasSubstr("set yrange [1.95:3.05]"));
}

}  // namespace
}  // namespace koboshi::tools
