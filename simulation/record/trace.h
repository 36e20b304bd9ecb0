#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/canopen/described_object.h"

namespace koboshi::simulation {

enum class TraceKind : std::uint8_t { kReal, kInteger };

// A column of trace.csv. Its title is `name_unit`, or `name` for a number without a unit.
struct TraceColumn {
  std::string name;
  std::string unit{};
  TraceKind kind = TraceKind::kReal;
  // Value names of an integer column, written instead of the number. The names contain no comma; such columns
  // have no unit.
  std::span<const canopen::ValueName> names{};

  std::string title() const { return unit.empty() ? name : name + '_' + unit; }
};

// A cell. NaN represents an invalid value.
struct TraceValue {
  TraceValue(double value) : bits(std::bit_cast<std::uint64_t>(value)), kind(TraceKind::kReal) {}
  template <std::integral Integer>
  TraceValue(Integer value)
      : bits(static_cast<std::uint64_t>(static_cast<std::int64_t>(value))), kind(TraceKind::kInteger) {}

  double number() const {
    return kind == TraceKind::kReal ? std::bit_cast<double>(bits)
                                    : static_cast<double>(static_cast<std::int64_t>(bits));
  }

  std::uint64_t bits;
  TraceKind kind;
};

// Formats trace.csv. The first column is `time_s`, exact to the microsecond; numbers have the shortest form
// that reads back the same; NaN gives an empty cell. Returned text is valid until the next call.
class TraceFormatter {
 public:
  explicit TraceFormatter(std::vector<TraceColumn> columns);

  const std::vector<TraceColumn>& columns() const { return columns_; }
  std::string header() const;
  // Formats one line. `cells` contains the bits of a TraceValue for each column.
  std::string_view row(std::uint64_t time_us, std::span<const std::uint64_t> cells);

 private:
  std::vector<TraceColumn> columns_;
  std::vector<char> line_;
  std::vector<char> last_line_;
  std::vector<std::uint64_t> last_cells_;
  std::uint32_t last_time_end_ = 0;       // in last_line_; cells follow
  std::vector<std::uint32_t> cell_ends_;  // in last_line_
  bool has_last_ = false;
};

}  // namespace koboshi::simulation
