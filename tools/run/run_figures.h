#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "simulation/record/trace.h"
#include "simulation/scenario/scenario.h"
#include "tools/plot/figure.h"

namespace koboshi::tools {

// The columns of a run's trace that its figures show, and the time. Memory is bounded: a trace longer than
// kMaxRows is thinned to every second row, every fourth and so on, as often as needed.
class ShownTrace {
 public:
  static constexpr std::size_t kMaxRows = 120'000;  // 20 minutes at 100 Hz, about 50 MB

  // `columns` are those of the trace. Columns of joints go by the joints' roles.
  ShownTrace(const std::vector<simulation::TraceColumn>& columns, const sim_board::RobotDescription& robot);

  // A row of the trace.
  void add(std::uint64_t time_us, std::span<const simulation::TraceValue> row);
  const Columns& columns() const { return columns_; }

 private:
  void thin_out();

  std::uint64_t rows_ = 0;          // of the trace
  std::uint64_t stride_ = 1;        // rows of the trace for one that is kept
  std::vector<std::size_t> cells_;  // the cell of a row for each column but the first, the time
  Columns columns_;
};

// Draws the figures of a run, as PNG and SVG: body.* (height, inclination, feet) and legs.* (targets and
// positions). Throws PlotError.
void draw_run_figures(const simulation::Scenario& scenario, const Columns& trace,
                      const std::filesystem::path& folder);

}  // namespace koboshi::tools
