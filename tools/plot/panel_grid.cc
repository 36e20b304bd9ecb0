#include "tools/plot/panel_grid.h"

#include <sstream>

#include "base/text/text.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/layout.h"

namespace koboshi::tools {
namespace {

constexpr int kTitleRow_px = 38;   // above the key
constexpr int kPanelLeft_px = 74;  // tick labels and label of the ordinate
constexpr int kPanelFoot_px = 62;  // tick labels and label of the abscissa
constexpr int kPanelHead_px = 30;  // title of the panel
constexpr int kGridRight_px = 12;  // margin of the page

struct Layout {
  explicit Layout(const PanelGrid& grid)
      : columns(grid.columns),
        rows((static_cast<int>(grid.panels.size()) + grid.columns - 1) / grid.columns),
        cell_width_px((kWidth_px - kGridRight_px) / grid.columns),
        cell_height_px(grid.panel_height_px),
        head_px(head_of(grid)),
        page_px(head_px + rows * grid.panel_height_px) {}

  std::string across(int px) const { return number_text(static_cast<double>(px) / kWidth_px); }
  std::string from_top(int px) const { return number_text(1.0 - static_cast<double>(px) / page_px); }

  int columns;
  int rows;
  int cell_width_px;
  int cell_height_px;
  int head_px;  // title and key, a row for each entry
  int page_px;

 private:
  static int head_of(const PanelGrid& grid) {
    int entries = 0;
    if (!grid.panels.empty()) {
      for (const PlaneCurve& curve : grid.panels.front().curves) entries += curve.label.empty() ? 0 : 1;
    }
    return kTitleRow_px + entries * kKeyRow_px;
  }
};

std::string grid_block_name(std::size_t panel, std::size_t curve) {
  return "$panel" + std::to_string(panel) + "_" + std::to_string(curve);
}

std::string style_text(const PlaneCurve& curve) {
  const bool points = curve.style == LineStyle::kLinesPoints || curve.style == LineStyle::kPoints;
  const std::string with = curve.style == LineStyle::kPoints ? "points" : points ? "linespoints" : "lines";
  const std::string shape = points ? " pointtype 7 pointsize 0.6" : "";
  const std::string dash = curve.style == LineStyle::kDashed ? " dashtype (9,5)" : "";
  return " with " + with + shape + " linewidth " + number_text(curve.width) + " linecolor '" +
         palette_colour(static_cast<std::size_t>(curve.colour)) + "'" + dash;
}

// Every panel plots the same way, but only the first has the key: it is that of the page.
void write_panel(std::ostream& out, const PanelGrid& grid, std::size_t number, const Layout& layout) {
  const GridPanel& panel = grid.panels[number];
  const int left_px = static_cast<int>(number) % layout.columns * layout.cell_width_px;
  const int top_px = layout.head_px + static_cast<int>(number) / layout.columns * layout.cell_height_px;
  out << "set lmargin at screen " << layout.across(left_px + kPanelLeft_px) << "\nset rmargin at screen "
      << layout.across(left_px + layout.cell_width_px - kGridRight_px) << "\nset tmargin at screen "
      << layout.from_top(top_px + kPanelHead_px) << "\nset bmargin at screen "
      << layout.from_top(top_px + layout.cell_height_px - kPanelFoot_px) << "\n";
  out << "unset logscale\n";
  if (panel.log_x) out << "set logscale x\n";
  if (panel.log_y) out << "set logscale y\n";
  out << "set title " << quoted(panel.title) << " offset 0,-0.6 font ',11'\nset xlabel "
      << quoted(panel.x_label) << "\nset ylabel " << quoted(panel.y_label) << "\n";
  out << "set autoscale\n";
  if (panel.y_span)
    out << "set yrange [" << number_text(panel.y_span->low) << ":" << number_text(panel.y_span->high)
        << "]\n";
  if (number == 0) {
    out << "set key vertical left Left reverse top at screen " << layout.across(kPanelLeft_px) << ", screen "
        << layout.from_top(kTitle_px + 8) << " samplen 2 textcolor '#303030'\n";
  } else {
    out << "unset key\n";
  }
  out << "plot ";
  if (panel.curves.empty()) out << "1/0 notitle";
  for (std::size_t curve = 0; curve < panel.curves.size(); ++curve) {
    const std::string& label = panel.curves[curve].label;
    out << (curve > 0 ? ", " : "") << grid_block_name(number, curve) << style_text(panel.curves[curve])
        << (label.empty() ? std::string(" notitle") : " title " + quoted(label));
  }
  out << "\n";
}

}  // namespace

std::string gnuplot_script(const PanelGrid& grid) {
  const Layout layout(grid);
  std::ostringstream out;
  for (std::size_t panel = 0; panel < grid.panels.size(); ++panel) {
    for (std::size_t curve = 0; curve < grid.panels[panel].curves.size(); ++curve)
      write_block(out, grid_block_name(panel, curve), grid.panels[panel].curves[curve].points);
  }
  out << axes_style();
  for (const char* extension : kPageExtensions) {
    out << open_page(extension, kWidth_px, layout.page_px) << "set multiplot\nset label 1 "
        << quoted(grid.title) << " at screen " << layout.across(kPanelLeft_px) << ", screen "
        << layout.from_top(kTitle_px) << " left font ',14'\n";
    for (std::size_t panel = 0; panel < grid.panels.size(); ++panel) {
      write_panel(out, grid, panel, layout);
      if (panel == 0) out << "unset label 1\n";
    }
    out << "unset multiplot\nset output\n";
  }
  return out.str();
}

void draw(const PanelGrid& grid, const std::filesystem::path& without_extension) {
  run_gnuplot(gnuplot_script(grid), without_extension);
}

}  // namespace koboshi::tools
