#include "tools/plot/gnuplot_script.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "sim_board/input/text.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/layout.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kBuckets = 1000;  // about one a pixel
constexpr int kPanelHeight_px = 240;
constexpr int kHead_px = 92;           // title, the marks' labels, the first key
constexpr int kMarks_px = 56;          // from the top to the base line of the marks' labels
constexpr int kMarkRow_px = 14;        // a label that would run into another stands a row higher
constexpr double kMarkGlyph_px = 6.2;  // mean width of a label's letter
constexpr int kGap_px = 36;            // between panels, for the key of the lower one
constexpr int kYLabel_px = 24;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (std::isnan(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

std::string block_name(std::size_t panel, std::size_t series) {
  return "$panel" + std::to_string(panel) + "_series" + std::to_string(series);
}

// Some air around positive data on a logarithmic axis.
Range padded_log(Range data) {
  if (data.low > data.high) data = {1.0, 1.0};
  const double margin = std::pow(data.high / data.low, 0.08) * 1.1;
  return {data.low / margin, data.high * margin};
}

// The part of a plot command that says what a line looks like.
std::string with_style(LineStyle style, const std::string& colour) {
  const std::string points = " pointtype 7 pointsize 0.9";
  const std::string line = " linewidth 1.8 linecolor '" + colour + "'";
  if (style == LineStyle::kPoints) return "with points" + line + points;
  if (style == LineStyle::kLinesPoints) return "with linespoints" + line + points;
  return "with lines" + line + " dashtype " + (style == LineStyle::kDashed ? "(9,5)" : "1");
}

// Some air around the data, and never less than the smallest span.
Range padded(Range data, double smallest_span) {
  if (data.low > data.high) data = {0.0, 0.0};
  double span = std::max(data.high - data.low, smallest_span);
  if (span == 0.0) span = 1.0;
  const double middle = 0.5 * (data.low + data.high);
  return {middle - 0.55 * span, middle + 0.55 * span};
}

class Script {
 public:
  Script(const Figure& figure, const Columns& columns) : figure_(figure), columns_(columns) {}

  std::string write() {
    write_data();
    write_style();
    for (const char* const extension : kPageExtensions) write_page(extension);
    return out_.str();
  }

 private:
  int height_px() const {
    const int panels = static_cast<int>(figure_.panels.size());
    return kHead_px + panels * kPanelHeight_px + (panels - 1) * kGap_px + kFoot_px;
  }

  void write_data() {
    const std::vector<double>& all_x = columns_.at(figure_.x_column);
    const auto shown = [&](std::size_t i) {
      return !figure_.x_span || (figure_.x_span->low <= all_x[i] && all_x[i] <= figure_.x_span->high);
    };
    const auto cut = [&](const std::vector<double>& values, double factor) {
      std::vector<double> part;
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (shown(i)) part.push_back(factor * values[i]);
      }
      return part;
    };
    const std::vector<double> x = cut(all_x, 1.0);
    for (const double value : x) x_range_.include(value);
    for (std::size_t p = 0; p < figure_.panels.size(); ++p) {
      const Panel& panel = figure_.panels[p];
      Range range;
      for (std::size_t s = 0; s < panel.series.size(); ++s) {
        const std::vector<double> y = cut(columns_.at(panel.series[s].column), panel.series[s].factor);
        for (const double value : y) range.include(value);
        write_block(out_, block_name(p, s), thin(x, y, kBuckets));
      }
      y_ranges_.push_back(figure_.log_log ? padded_log(range) : padded(range, panel.smallest_span));
    }
  }

  void write_style() {
    if (figure_.log_log) {
      x_range_ = padded_log(x_range_);
    } else if (x_range_.low >= x_range_.high) {
      x_range_ = padded(x_range_, 0.0);
    }
    out_ << axes_style() << (figure_.log_log ? "set logscale xy\n" : "")
         << "set key horizontal right bottom at graph 1,1.01 samplen 2 spacing 1 textcolor '#303030'\n"
         << "set xrange [" << sim::number_text(x_range_.low) << ":" << sim::number_text(x_range_.high)
         << "]\n";
  }

  void write_page(const std::string& extension) {
    out_ << open_page(extension, kWidth_px, height_px()) << "set multiplot\n";
    out_ << "set label " << quoted(figure_.title) << " at screen " << screen_x(kLeft_px) << ", screen "
         << screen_y(kTitle_px) << " left font ',14'\n";
    for (std::size_t p = 0; p < figure_.panels.size(); ++p) write_panel(p);
    out_ << "unset multiplot\nset output\n";
  }

  void write_panel(std::size_t p) {
    const Panel& panel = figure_.panels[p];
    const bool last = p + 1 == figure_.panels.size();
    const double top = kHead_px + static_cast<double>(p) * (kPanelHeight_px + kGap_px);
    out_ << "set lmargin at screen " << screen_x(kLeft_px) << "\nset rmargin at screen "
         << screen_x(kWidth_px - kRight_px) << "\nset tmargin at screen " << screen_y(top)
         << "\nset bmargin at screen " << screen_y(top + kPanelHeight_px) << '\n';
    out_ << "set format x " << (last ? "'%g'" : "''") << "\nset xlabel "
         << quoted(last ? figure_.x_label : "") << "\nset yrange [" << sim::number_text(y_ranges_[p].low)
         << ":" << sim::number_text(y_ranges_[p].high) << "]\n";
    // A label and no ylabel, which would stand elsewhere in each panel, as wide as its tics' numbers are.
    out_ << "set label " << quoted(panel.y_label) << " at screen " << screen_x(kYLabel_px)
         << ", graph 0.5 center rotate\n";
    write_marks(p == 0);
    out_ << "plot ";
    for (std::size_t s = 0; s < panel.series.size(); ++s) out_ << (s > 0 ? ", " : "") << curve(p, s);
    out_ << "\nunset label\nunset arrow\n";
  }

  // In the first panel the lines reach up to their labels.
  void write_marks(bool with_labels) {
    double taken_px = 0.0;  // end of the last label in the lower row
    for (const Mark& mark : figure_.marks) {
      const double left_px = x_px(mark.x);
      const bool higher = left_px < taken_px;
      if (!higher) taken_px = left_px + kMarkGlyph_px * static_cast<double>(mark.label.size());
      const int label_px = kMarks_px - (higher ? kMarkRow_px : 0);
      const std::string x = "first " + sim::number_text(mark.x) + ", ";
      const std::string top = with_labels ? "screen " + sim::number_text(screen_y(label_px)) : "graph 1";
      out_ << "set arrow from " << x << "graph 0 to " << x << top
           << " nohead back linewidth 1 linecolor '#A0A0A0' dashtype (4,4)\n";
      if (!with_labels) continue;
      const bool at_the_end = mark.x > x_range_.low + 0.9 * (x_range_.high - x_range_.low);
      out_ << "set label " << quoted(mark.label) << " at " << x << top << " offset 0,0.5 "
           << (at_the_end ? "right" : "left") << " font ',9' textcolor '#606060'\n";
    }
  }

  std::string curve(std::size_t p, std::size_t s) const {
    const Series& series = figure_.panels[p].series[s];
    const std::size_t colour = series.colour ? static_cast<std::size_t>(*series.colour) : s;
    return block_name(p, s) + " using 1:2 " + with_style(series.style, palette_colour(colour)) +
           (series.label.empty() ? " notitle" : " title " + quoted(series.label));
  }

  double x_px(double x) const {
    const double part = (x - x_range_.low) / (x_range_.high - x_range_.low);
    return kLeft_px + part * (kWidth_px - kRight_px - kLeft_px);
  }
  double screen_x(double from_left_px) const { return from_left_px / kWidth_px; }
  double screen_y(double from_top_px) const { return 1.0 - from_top_px / height_px(); }

  const Figure& figure_;
  const Columns& columns_;
  std::ostringstream out_;
  Range x_range_;
  std::vector<Range> y_ranges_;
};

}  // namespace

std::string gnuplot_script(const Figure& figure, const Columns& columns) {
  return Script(figure, columns).write();
}

}  // namespace koboshi::tools
