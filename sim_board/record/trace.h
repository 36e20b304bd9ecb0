#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/canopen/described_object.h"

namespace koboshi::sim {

enum class TraceKind : std::uint8_t { kReal, kInteger };

// A column of trace.csv. Its title is `name_unit`, or the name alone for a number without a unit.
struct TraceColumn {
  std::string name;
  std::string unit{};
  TraceKind kind = TraceKind::kReal;
  // Of an integer that is written as the name of its value, without a comma in it; such columns have no unit.
  std::span<const canopen::ValueName> names{};
};

// One cell. A value that is not valid is NaN.
struct TraceValue {
  TraceValue(double value) : bits(std::bit_cast<std::uint64_t>(value)), kind(TraceKind::kReal) {}
  template <std::integral Integer>
  TraceValue(Integer value)
      : bits(static_cast<std::uint64_t>(static_cast<std::int64_t>(value))), kind(TraceKind::kInteger) {}

  std::uint64_t bits;
  TraceKind kind;
};

// Writes the text of trace.csv: first column `time_s`, exact to the microsecond; numbers as short as they
// read back the same; an empty cell for NaN. The text stays valid until the next call.
class TraceFormatter {
 public:
  explicit TraceFormatter(std::vector<TraceColumn> columns);

  const std::vector<TraceColumn>& columns() const { return columns_; }
  std::string header() const;
  // One line. The cells are a TraceValue's bits, as many as there are columns.
  std::string_view row(std::uint64_t time_us, std::span<const std::uint64_t> cells);

 private:
  std::vector<TraceColumn> columns_;
  std::vector<char> line_;
};

}  // namespace koboshi::sim
