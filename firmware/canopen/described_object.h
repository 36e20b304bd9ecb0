#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string_view>

#include "firmware/canopen/object.h"

// A table of a node's objects with their texts is the one source of everything that is known of them: the
// rows in flash (rows_of), and what tools/dictionary writes for people and programs (EDS, DBC, reference
// page). The tables are constants that the firmware reads while it is compiled and never after: no text costs
// flash.
namespace koboshi::canopen {

struct ValueName {
  std::int32_t value;
  std::string_view name;
};

// What a value is called; empty where it has no name.
constexpr std::string_view name_of(std::span<const ValueName> names, std::int64_t value) {
  const auto named =
      std::ranges::find_if(names, [value](const ValueName& candidate) { return candidate.value == value; });
  return named == names.end() ? std::string_view() : named->name;
}

// Sensors whose counts the robot's file gives a worth: Unit::name is then the unit, and the file has the
// factor.
enum class Resolution : std::uint8_t { kNone, kGyro, kAccelerometer, kForce, kTorque };

// A value is raw * numerator / denominator of the unit; exactly so, and without floats.
struct Unit {
  std::string_view name = {};
  std::int32_t numerator = 1;
  std::int32_t denominator = 1;
  Resolution resolution = Resolution::kNone;
};

struct ObjectText {
  std::string_view name = {};  // of an index, or of a sub-index
  Unit unit = {};
  std::span<const ValueName> values = {};
  std::span<const std::string_view> elements =
      {};                         // of a repeated row: each name's last word; else its number
  std::string_view comment = {};  // one line
};

struct DescribedObject {
  Entry entry;  // count 0: of no row, a heading
  ObjectText text;

  constexpr bool is_heading() const { return entry.count == 0; }
};

// The name of an index with sub-indices, which stands above their rows.
constexpr DescribedObject heading(std::uint16_t index, std::string_view name, std::string_view comment = {}) {
  return {.entry = {.index = index, .count = 0}, .text = {.name = name, .comment = comment}};
}

inline constexpr std::string_view kAxes[] = {"x", "y", "z"};

// The rows of a table, which must have static storage, without their texts.
template <const auto& kTable>
consteval auto rows_of() {
  constexpr auto kHasRow = [](const DescribedObject& object) { return !object.is_heading(); };
  std::array<Entry, std::count_if(std::begin(kTable), std::end(kTable), kHasRow)> rows;
  auto row = rows.begin();
  for (const DescribedObject& object : kTable) {
    if (kHasRow(object)) *row++ = object.entry;
  }
  return rows;
}

// A name for every row, as many elements as the row has where it names any, and a heading wherever an index
// has sub-indices: to be asserted of every table.
constexpr bool is_described(std::span<const DescribedObject> table) {
  std::uint16_t headed = 0;
  for (const DescribedObject& object : table) {
    if (object.text.name.empty() || object.text.unit.denominator <= 0) return false;
    if (object.is_heading()) headed = object.entry.index;
    if (object.entry.subindex != 0 && object.entry.index != headed) return false;
    if (!object.text.elements.empty() && object.text.elements.size() != object.entry.count) return false;
  }
  return true;
}

}  // namespace koboshi::canopen
