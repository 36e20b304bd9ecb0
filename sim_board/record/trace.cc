#include "sim_board/record/trace.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <utility>

namespace koboshi::sim {
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

std::size_t max_cell_bytes(const std::vector<TraceColumn>& columns) {
  std::size_t most = kMaxCellBytes;
  for (const TraceColumn& column : columns) {
    for (const canopen::ValueName& value : column.names) most = std::max(most, 1 + value.name.size());
  }
  return most;
}

}  // namespace

TraceFormatter::TraceFormatter(std::vector<TraceColumn> columns)
    : columns_(std::move(columns)), line_(kMaxTimeBytes + columns_.size() * max_cell_bytes(columns_)) {}

std::string TraceFormatter::header() const {
  std::string header = "time_s";
  for (const TraceColumn& column : columns_) header += ',' + column.title();
  return header + '\n';
}

std::string_view TraceFormatter::row(std::uint64_t time_us, std::span<const std::uint64_t> cells) {
  assert(cells.size() == columns_.size());
  char* const end = line_.data() + line_.size();
  char* out = put_seconds(line_.data(), end, time_us);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    *out++ = ',';
    if (const auto& names = columns_[i].names; !names.empty()) {
      out = std::ranges::copy(canopen::name_of(names, static_cast<std::int64_t>(cells[i])), out).out;
    } else if (columns_[i].kind == TraceKind::kInteger) {
      out = put(out, end, static_cast<std::int64_t>(cells[i]));
    } else if (const double value = std::bit_cast<double>(cells[i]); !std::isnan(value)) {
      out = put(out, end, value);
    }
  }
  *out++ = '\n';
  return {line_.data(), static_cast<std::size_t>(out - line_.data())};
}

}  // namespace koboshi::sim
