#include "tools/diff/report.h"

#include <algorithm>
#include <iterator>

#include <fmt/core.h>

#include "tools/diff/log_diff.h"
#include "tools/diff/trace_diff.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kMaxCells = 12;  // shown of a tick; the report counts the others

std::string describe(const TraceDifference& difference) {
  if (difference.ended) {
    return fmt::format("trace.csv: {} ends before line {}, the tick at {} s\n", *difference.ended,
                       difference.line, difference.time_s);
  }
  std::string text = difference.line == 1 ? std::string("trace.csv: the headers differ\n")
                                          : fmt::format("trace.csv: line {}, the tick at {} s\n",
                                                        difference.line, difference.time_s);
  const std::size_t shown = std::min(difference.cells.size(), kMaxCells);
  for (std::size_t i = 0; i < shown; ++i) {
    const CellDifference& cell = difference.cells[i];
    text += fmt::format("  {:<34} A {:<24} B {}\n", cell.column, cell.a, cell.b);
  }
  if (shown < difference.cells.size()) {
    text += fmt::format("  and {} more variables\n", difference.cells.size() - shown);
  }
  return text;
}

std::string describe(const LogDifference& difference) {
  std::string text = fmt::format("can.log: line {}\n", difference.line);
  for (const sim_board::LoggedFrame& frame : difference.before) text += "    " + sim_board::log_line(frame);
  for (const sim_board::LoggedFrame& frame : difference.a) text += "  A " + sim_board::log_line(frame);
  if (difference.a.empty()) text += "  A ends here\n";
  for (const sim_board::LoggedFrame& frame : difference.b) text += "  B " + sim_board::log_line(frame);
  if (difference.b.empty()) text += "  B ends here\n";
  return text;
}

// The frames before a tick, for a difference of the trace alone.
std::string frames_before(const std::filesystem::path& log, const std::string& time_s) {
  sim_board::CandumpReader reader(log);
  const double end_us = 1e6 * std::stod(time_s);
  std::vector<sim_board::LoggedFrame> last;
  while (const auto frame = reader.next()) {
    if (static_cast<double>(frame->time_us) > end_us) break;
    if (last.size() == 2 * kFramesBefore) last.erase(last.begin());
    last.push_back(*frame);
  }
  std::string text = "can.log: the same; before that tick\n";
  for (const sim_board::LoggedFrame& frame : last) text += "    " + sim_board::log_line(frame);
  return text;
}

}  // namespace

RunComparison compare_runs(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto trace = compare_traces(a / "trace.csv", b / "trace.csv");
  const auto log = compare_logs(a / "can.log", b / "can.log");
  if (!trace && !log) return {true, "the same trace.csv and can.log\n"};
  std::string text = fmt::format("A is {}\nB is {}\n", a.string(), b.string());
  if (trace) text += describe(*trace);
  if (log) text += describe(*log);
  if (!log && trace->line > 1) text += frames_before(a / "can.log", trace->time_s);
  if (!trace) text += "trace.csv: the same\n";
  return {false, text};
}

}  // namespace koboshi::tools
