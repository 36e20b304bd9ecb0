#include "tools/plot/plane_figure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/text/text.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/layout.h"

namespace koboshi::tools {
namespace {

constexpr int kMaxHeight_px = 700;  // of the plane
constexpr int kPlaneHead_px = 66;   // title and a row of the key
constexpr double kKeySample_px = 60.0;
constexpr double kMargin = 0.04;  // of the data's extent, around it

// The part of the plane that is shown, and how large.
struct View {
  double x_low = std::numeric_limits<double>::infinity();
  double x_high = -x_low;
  double y_low = x_low;
  double y_high = -x_low;
  int height_px = 0;

  void include(const std::vector<Point>& points) {
    for (const Point& point : points) {
      if (std::isnan(point.x) || std::isnan(point.y)) continue;
      x_low = std::min(x_low, point.x);
      x_high = std::max(x_high, point.x);
      y_low = std::min(y_low, point.y);
      y_high = std::max(y_high, point.y);
    }
  }

  // Equal axes: the width is given, so that either the height follows, or the abscissa is widened.
  void fit() {
    if (x_low > x_high) *this = {.x_low = 0.0, .x_high = 1.0, .y_low = 0.0, .y_high = 0.5};
    const double margin = kMargin * std::max({x_high - x_low, y_high - y_low, 1e-9});
    x_low -= margin;
    x_high += margin;
    y_low -= margin;
    y_high += margin;
    const double width_px = kWidth_px - kLeft_px - kRight_px;
    const double scale = std::min(width_px / (x_high - x_low), kMaxHeight_px / (y_high - y_low));
    const double missing = width_px / scale - (x_high - x_low);
    x_low -= 0.5 * missing;
    x_high += 0.5 * missing;
    height_px = static_cast<int>(std::lround(scale * (y_high - y_low)));
  }
};

// Rows of the key: gnuplot makes its columns as wide as the longest entry.
int key_rows(const PlaneFigure& figure) {
  double widest_px = 1.0;
  int entries = 0;
  for (const PlaneCurve& curve : figure.curves) {
    if (curve.label.empty()) continue;
    ++entries;
    widest_px = std::max(widest_px, kKeySample_px + kKeyGlyph_px * static_cast<double>(curve.label.size()));
  }
  const int columns = std::max(1, static_cast<int>((kWidth_px - kLeft_px - kRight_px) / widest_px));
  return std::max(1, (entries + columns - 1) / columns);
}

View view_of(const PlaneFigure& figure) {
  View view;
  for (const Outline& outline : figure.outlines) view.include(outline.corners);
  for (const PlaneCurve& curve : figure.curves) view.include(curve.points);
  view.fit();
  return view;
}

std::string range(double low, double high) { return "[" + number_text(low) + ":" + number_text(high) + "]"; }

void write_words(std::ostream& out, const PlaneFigure& figure) {
  for (const Outline& outline : figure.outlines) {
    out << "set label " << quoted(outline.word) << " at " << number_text(outline.word_at.x) << ","
        << number_text(outline.word_at.y) << " center font ',9' textcolor '#909090'\n";
  }
}

std::string plot_command(const PlaneFigure& figure) {
  std::ostringstream plots;
  for (std::size_t i = 0; i < figure.outlines.size(); ++i) {
    const std::string name = "$outline" + std::to_string(i);
    const std::string colour =
        "'" + palette_colour(static_cast<std::size_t>(figure.outlines[i].colour)) + "'";
    plots << name << " with filledcurves closed fillcolor " << colour
          << " fillstyle transparent solid 0.10 noborder notitle, " << name
          << " with lines linewidth 1 linecolor " << colour << " notitle, ";
  }
  for (std::size_t i = 0; i < figure.curves.size(); ++i) {
    const PlaneCurve& curve = figure.curves[i];
    const bool points = curve.style == LineStyle::kLinesPoints;
    plots << "$curve" << i << " with " << (points ? "linespoints pointtype 7 pointsize " : "lines")
          << (points ? number_text(0.4 + 0.25 * curve.width) : "") << " linewidth "
          << number_text(curve.width) << " linecolor '"
          << palette_colour(static_cast<std::size_t>(curve.colour)) << "' dashtype "
          << (curve.style == LineStyle::kDashed ? "(9,5)" : "1")
          << (curve.label.empty() ? std::string(" notitle") : " title " + quoted(curve.label)) << ", ";
  }
  const std::string text = plots.str();
  return "plot " + text.substr(0, text.size() - 2) + "\n";
}

}  // namespace

void draw(const PlaneFigure& figure, const std::filesystem::path& without_extension) {
  const View view = view_of(figure);
  const int head_px = kPlaneHead_px + (key_rows(figure) - 1) * kKeyRow_px;
  const int page_px = head_px + view.height_px + kFoot_px;
  const auto from_top = [&](int px) { return number_text(1.0 - static_cast<double>(px) / page_px); };
  const auto from_left = [](int px) { return number_text(static_cast<double>(px) / kWidth_px); };
  std::ostringstream out;
  for (std::size_t i = 0; i < figure.outlines.size(); ++i) {
    std::vector<Point> closed = figure.outlines[i].corners;
    closed.push_back(closed.front());
    write_block(out, "$outline" + std::to_string(i), closed);
  }
  for (std::size_t i = 0; i < figure.curves.size(); ++i) {
    write_block(out, "$curve" + std::to_string(i), figure.curves[i].points);
  }
  out << axes_style() << "set key horizontal right bottom at graph 1,1.01 samplen 2 textcolor '#303030'\n"
      << "set lmargin at screen " << from_left(kLeft_px) << "\nset rmargin at screen "
      << from_left(kWidth_px - kRight_px) << "\nset tmargin at screen " << from_top(head_px)
      << "\nset bmargin at screen " << from_top(head_px + view.height_px) << "\nset xrange "
      << range(view.x_low, view.x_high) << "\nset yrange " << range(view.y_low, view.y_high)
      << "\nset xlabel " << quoted(figure.x_label) << "\nset ylabel " << quoted(figure.y_label)
      << "\nset label " << quoted(figure.title) << " at screen " << from_left(kLeft_px) << ", screen "
      << from_top(kTitle_px) << " left font ',14'\n";
  write_words(out, figure);
  for (const char* extension : kPageExtensions) {
    out << open_page(extension, kWidth_px, page_px) << plot_command(figure) << "set output\n";
  }
  run_gnuplot(out.str(), without_extension);
}

}  // namespace koboshi::tools
