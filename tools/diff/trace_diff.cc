#include "tools/diff/trace_diff.h"

#include <algorithm>
#include <fstream>

#include "base/text/error.h"
#include "base/text/foreign_text.h"

namespace koboshi::tools {
namespace {

using Cells = std::vector<std::string>;

Cells split(const std::string& line) {
  Cells cells(1);
  bool is_quoted = false;  // as a name with a comma is in the header
  for (const char letter : line) {
    is_quoted = is_quoted != (letter == '"');
    if (letter == ',' && !is_quoted) {
      cells.emplace_back();
    } else {
      cells.back() += letter;
    }
  }
  return cells;
}

class TraceLines {
 public:
  explicit TraceLines(const std::filesystem::path& file)
      : file_(file), stream_(file, std::ios::binary), lines_(stream_) {
    if (!stream_) throw InputError(file, 0, "no file that can be read", "the trace of a run");
    if (!next()) throw InputError(file, 0, "nothing", "a header line and rows");
    columns_ = split(line_);
  }

  bool next() { return lines_.next(line_) && ++number_ > 0; }
  const std::string& text() const { return line_; }
  int number() const { return number_; }
  const Cells& columns() const { return columns_; }
  std::string time_s() const { return line_.substr(0, line_.find(',')); }
  Cells cells() const {
    Cells cells = split(line_);
    if (cells.size() != columns_.size()) {
      throw InputError(file_, number_, std::to_string(cells.size()) + " cells",
                       "as many as the header has, " + std::to_string(columns_.size()));
    }
    return cells;
  }

 private:
  std::filesystem::path file_;
  std::ifstream stream_;
  LineReader lines_;
  std::string line_;
  int number_ = 0;
  Cells columns_;
};

TraceDifference compare_headers(const Cells& a, const Cells& b) {
  TraceDifference difference{.line = 1, .time_s = {}, .cells = {}, .ended = {}};
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const std::string name_a = i < a.size() ? a[i] : "";
    const std::string name_b = i < b.size() ? b[i] : "";
    if (name_a != name_b) {
      difference.cells.push_back({"column " + std::to_string(i + 1), name_a, name_b});
    }
  }
  return difference;
}

TraceDifference compare_rows(const TraceLines& a, const TraceLines& b) {
  TraceDifference difference{.line = a.number(), .time_s = a.time_s(), .cells = {}, .ended = {}};
  const Cells cells_a = a.cells();
  const Cells cells_b = b.cells();
  for (std::size_t i = 0; i < cells_a.size(); ++i) {
    if (cells_a[i] != cells_b[i]) difference.cells.push_back({a.columns()[i], cells_a[i], cells_b[i]});
  }
  return difference;
}

}  // namespace

std::optional<TraceDifference> compare_traces(const std::filesystem::path& file_a,
                                              const std::filesystem::path& file_b) {
  TraceLines a(file_a);
  TraceLines b(file_b);
  if (a.columns() != b.columns()) return compare_headers(a.columns(), b.columns());
  for (;;) {
    const bool more_a = a.next();
    const bool more_b = b.next();
    if (!more_a && !more_b) return std::nullopt;
    if (more_a != more_b) {
      const TraceLines& longer = more_a ? a : b;
      return TraceDifference{longer.number(), longer.time_s(), {}, more_a ? 'B' : 'A'};
    }
    if (a.text() != b.text()) return compare_rows(a, b);
  }
}

}  // namespace koboshi::tools
