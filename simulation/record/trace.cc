#include "simulation/record/trace.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <utility>

namespace koboshi::simulation {
namespace {

constexpr std::size_t kMaxCellBytes =
    26;  // a comma, and at most 24 characters of a double or 20 of an integer
constexpr std::size_t kMaxTimeBytes = 32;
constexpr std::uint64_t kMicrosecondsPerSecond = 1'000'000;

template <typename Number>
char* put(char* out, char* end, Number value) {
  return std::to_chars(out, end, value).ptr;
}

// Writes seconds as an exact decimal number.
char* put_seconds(char* out, char* end, std::uint64_t time_us) {
  out = put(out, end, time_us / kMicrosecondsPerSecond);
  std::uint64_t fraction_us = time_us % kMicrosecondsPerSecond;
  if (fraction_us == 0) return out;
  *out++ = '.';
  for (std::uint64_t place_us = kMicrosecondsPerSecond / 10; fraction_us > 0; place_us /= 10) {
    *out++ = static_cast<char>('0' + fraction_us / place_us);
    fraction_us %= place_us;
  }
  return out;
}

// A name of a robot's file may hold commas and quotes (RFC 4180).
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + '"';
}

// Writes a comma and the cell.
char* put_cell(char* out, char* end, const TraceColumn& column, std::uint64_t cell) {
  *out++ = ',';
  if (!column.names.empty())
    return std::ranges::copy(canopen::name_of(column.names, static_cast<std::int64_t>(cell)), out).out;
  if (column.kind == TraceKind::kInteger) return put(out, end, static_cast<std::int64_t>(cell));
  const double value = std::bit_cast<double>(cell);
  return std::isnan(value) ? out : put(out, end, value);
}

std::size_t max_cell_bytes(const std::vector<TraceColumn>& columns) {
  std::size_t most = kMaxCellBytes;
  for (const TraceColumn& column : columns) {
    for (const canopen::ValueName& value : column.names) most = std::max(most, 1 + value.name.size());
  }
  return most;
}

}  // namespace

TraceFormatter::TraceFormatter(std::vector<TraceColumn> columns)
    : columns_(std::move(columns)),
      line_(kMaxTimeBytes + columns_.size() * max_cell_bytes(columns_)),
      last_line_(line_.size()),
      last_cells_(columns_.size()),
      cell_ends_(columns_.size()) {}

std::string TraceFormatter::header() const {
  std::string header = "time_s";
  for (const TraceColumn& column : columns_) header += ',' + csv_cell(column.title());
  return header + '\n';
}

std::string_view TraceFormatter::row(std::uint64_t time_us, std::span<const std::uint64_t> cells) {
  assert(cells.size() == columns_.size());
  std::swap(line_, last_line_);
  char* const end = line_.data() + line_.size();
  char* out = put_seconds(line_.data(), end, time_us);
  std::uint32_t last_begin = last_time_end_;
  last_time_end_ = static_cast<std::uint32_t>(out - line_.data());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::uint32_t last_end = cell_ends_[i];
    // Many values, such as targets of a robot that stands, are those of the last row: to copy a cell takes a
    // tenth of the time of formatting it.
    out = has_last_ && cells[i] == last_cells_[i]
              ? std::copy(&last_line_[last_begin], last_line_.data() + last_end, out)
              : put_cell(out, end, columns_[i], cells[i]);
    last_begin = last_end;
    cell_ends_[i] = static_cast<std::uint32_t>(out - line_.data());
    last_cells_[i] = cells[i];
  }
  has_last_ = true;
  *out++ = '\n';
  return {line_.data(), static_cast<std::size_t>(out - line_.data())};
}

}  // namespace koboshi::simulation
