#include "tools/plot/gnuplot_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <sstream>

#include "base/text/text.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/layout.h"
#include "tools/plot/unwrap.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kBuckets = 1000;  // about one a pixel
constexpr int kPanelHeight_px = 240;
constexpr int kTitleHead_px = 34;  // above the notes and the marks' labels
constexpr int kNoteHead_px = 20;
constexpr int kMarkRow_px = 14;   // of labels
constexpr int kMarkFoot_px = 36;  // from the base line of the lowest labels to the panel: the first key
constexpr int kMarkGap_px = 8;    // between two labels
constexpr std::size_t kMaxMarkRows = 5;
constexpr int kGap_px = 36;  // between panels, for the key of the lower one
constexpr int kYLabel_px = 24;
// Colours of curves without a role in the legend, by position.
constexpr std::array<std::size_t, 6> kNeutralColours{6, 5, 4, 2, 3, 7};

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

// The number of characters in a text.
std::size_t letters(const std::string& utf8) {
  return static_cast<std::size_t>(
      std::ranges::count_if(utf8, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

// Adds a margin around positive data on a logarithmic axis.
Range padded_log(Range data) {
  if (data.low > data.high) data = {1.0, 1.0};
  const double margin = std::pow(data.high / data.low, 0.08) * 1.1;
  return {data.low / margin, data.high * margin};
}

// The part of a plot command for the style of a line.
std::string with_style(LineStyle style, const std::string& colour) {
  const std::string points = " pointtype 7 pointsize 0.9";
  const std::string line = " linewidth 1.8 linecolor '" + colour + "'";
  if (style == LineStyle::kPoints) return "with points" + line + points;
  if (style == LineStyle::kLinesPoints) return "with linespoints" + line + points;
  return "with lines" + line + " dashtype " + (style == LineStyle::kDashed ? "(9,5)" : "1");
}

// Adds a margin around the data, and widens the range to the smallest span.
Range padded(Range data, double smallest_span) {
  if (data.low > data.high) data = {0.0, 0.0};
  double span = std::max(data.high - data.low, smallest_span);
  if (span == 0.0) span = 1.0;
  const double middle = 0.5 * (data.low + data.high);
  return {middle - 0.55 * span, middle + 0.55 * span};
}

// Removes the jumps of an angle at the ends of its range; a turn of 0: no angle.
void unwrap(std::vector<double>& values, double turn) {
  double last = std::numeric_limits<double>::quiet_NaN();
  for (double& value : values) {
    if (turn == 0.0 || std::isnan(value)) continue;
    last = value = unwrapped(last, value, turn);
  }
}

class Script {
 public:
  Script(const Figure& figure, const Columns& columns) : figure_(figure), columns_(columns) {}

  std::string write() {
    write_data();
    write_style();
    place_marks();
    for (const char* const extension : kPageExtensions) write_page(extension);
    return out_.str();
  }

 private:
  struct PlacedMark {
    const Mark* mark = nullptr;
    bool right_aligned = false;
    std::optional<std::size_t> row{};  // from below; none where there is no room
  };

  int head_px() const {
    const int note = figure_.note.empty() ? 0 : kNoteHead_px;
    return kTitleHead_px + note + static_cast<int>(mark_rows_) * kMarkRow_px + kMarkFoot_px;
  }

  // Places each label in the lowest row where it does not overlap another.
  void place_marks() {
    std::array<double, kMaxMarkRows> taken_px{};  // end of the last label in each row
    for (const Mark& mark : figure_.marks) {
      if (mark.x < x_range_.low || mark.x > x_range_.high) continue;
      const double width_px = kSmallGlyph_px * static_cast<double>(letters(mark.label));
      PlacedMark placed{.right_aligned = x_px(mark.x) + width_px > kWidth_px};
      const double left_px = x_px(mark.x) - (placed.right_aligned ? width_px : 0.0);
      for (std::size_t row = 0; row < kMaxMarkRows && !placed.row; ++row) {
        if (left_px < taken_px[row]) continue;
        placed.row = row;
        taken_px[row] = left_px + width_px + kMarkGap_px;
        mark_rows_ = std::max(mark_rows_, row + 1);
      }
      placed.mark = &mark;
      placed_marks_.push_back(placed);
    }
  }

  int height_px() const {
    const int panels = static_cast<int>(figure_.panels.size());
    return head_px() + panels * kPanelHeight_px + (panels - 1) * kGap_px + kFoot_px;
  }

  void write_data() {
    const std::vector<double>& all_x = values_of(columns_, figure_.x_column);
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
    if (figure_.x_span) x_range_ = {figure_.x_span->low, figure_.x_span->high};
    for (std::size_t p = 0; p < figure_.panels.size(); ++p) {
      const Panel& panel = figure_.panels[p];
      Range range;
      for (std::size_t s = 0; s < panel.series.size(); ++s) {
        const Series& series = panel.series[s];
        std::vector<double> y = cut(values_of(columns_, series.column), series.factor);
        unwrap(y, series.factor * turn_of(series.column));
        for (std::size_t i = 0; series.from_x && i < x.size(); ++i) {
          if (x[i] < *series.from_x) y[i] = std::numeric_limits<double>::quiet_NaN();
        }
        for (const double value : y) range.include(value);
        if (std::ranges::all_of(y, [](double value) { return std::isnan(value); })) empty_.emplace(p, s);
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
         << "set xrange [" << number_text(x_range_.low) << ":" << number_text(x_range_.high) << "]\n";
  }

  void write_page(const std::string& extension) {
    out_ << open_page(extension, kWidth_px, height_px()) << "set multiplot\n";
    out_ << "set label " << quoted(figure_.title) << " at screen " << screen_x(kLeft_px) << ", screen "
         << screen_y(kTitle_px) << " left font ',14'\n";
    if (!figure_.note.empty()) {
      out_ << "set label " << quoted(figure_.note) << " at screen " << screen_x(kLeft_px) << ", screen "
           << screen_y(kNote_px) << " left font ',9' textcolor '#606060'\n";
    }
    for (std::size_t p = 0; p < figure_.panels.size(); ++p) write_panel(p);
    out_ << "unset multiplot\nset output\n";
  }

  void write_panel(std::size_t p) {
    const Panel& panel = figure_.panels[p];
    const bool last = p + 1 == figure_.panels.size();
    const double top = head_px() + static_cast<double>(p) * (kPanelHeight_px + kGap_px);
    out_ << "set lmargin at screen " << screen_x(kLeft_px) << "\nset rmargin at screen "
         << screen_x(kWidth_px - kRight_px) << "\nset tmargin at screen " << screen_y(top)
         << "\nset bmargin at screen " << screen_y(top + kPanelHeight_px) << '\n';
    out_ << "set format x " << (last ? "'%g'" : "''") << "\nset xlabel "
         << quoted(last ? figure_.x_label : "") << "\nset yrange [" << number_text(y_ranges_[p].low) << ":"
         << number_text(y_ranges_[p].high) << "]\n";
    // A label instead of ylabel, whose position depends on the width of the tics' numbers.
    out_ << "set label " << quoted(panel.y_label) << " at screen " << screen_x(kYLabel_px)
         << ", graph 0.5 center rotate\n";
    write_marks(p == 0);
    out_ << "plot ";
    // Gnuplot refuses a plot of nothing: NaN stands for a panel whose curves have no values.
    out_ << "NaN notitle";
    // Dashed curves last: the curves below show through their gaps.
    for (const bool dashed : {false, true}) {
      for (std::size_t s = 0; s < panel.series.size(); ++s) {
        if ((panel.series[s].style == LineStyle::kDashed) != dashed || empty_.contains({p, s})) continue;
        out_ << ", " << curve(p, s);
      }
    }
    out_ << "\nunset label\nunset arrow\n";
  }

  // Draws the lines; in the first panel they reach up to their labels.
  void write_marks(bool first_panel) {
    for (const PlacedMark& placed : placed_marks_) {
      const Mark& mark = *placed.mark;
      const bool with_label = first_panel && placed.row.has_value();
      const int label_px = head_px() - kMarkFoot_px - static_cast<int>(placed.row.value_or(0)) * kMarkRow_px;
      const std::string x = "first " + number_text(mark.x) + ", ";
      const std::string top = with_label ? "screen " + number_text(screen_y(label_px)) : "graph 1";
      out_ << "set arrow from " << x << "graph 0 to " << x << top
           << " nohead back linewidth 1 linecolor '#A0A0A0' dashtype (4,4)\n";
      if (!with_label) continue;
      out_ << "set label " << quoted(mark.label) << " at " << x << top << " offset 0,0.5 "
           << (placed.right_aligned ? "right" : "left") << " font ',9' textcolor '#606060'\n";
    }
  }

  std::string curve(std::size_t p, std::size_t s) const {
    const Series& series = figure_.panels[p].series[s];
    const std::size_t colour = series.colour ? static_cast<std::size_t>(*series.colour)
                                             : kNeutralColours[s % kNeutralColours.size()];
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
  std::set<std::pair<std::size_t, std::size_t>> empty_;  // curves without values: panel, series
  std::vector<PlacedMark> placed_marks_;
  std::size_t mark_rows_ = 0;
};

}  // namespace

std::string gnuplot_script(const Figure& figure, const Columns& columns) {
  return Script(figure, columns).write();
}

}  // namespace koboshi::tools
