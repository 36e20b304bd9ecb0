#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi {

// The rule for numbers with units, in files and on the command line: a number without a unit is in the unit
// of its key. A number may have any unit of the same quantity, with or without a blank before it: 45 g, 45g.

// A unit in which people write a quantity whose unit in files is another.
struct UserUnit {
  std::string_view name;     // "g"
  std::string_view of_file;  // "kg"
  double rounding;           // of the file's value, as in files written by hand
  bool is_shown;             // the one in which editors show the quantity

  double factor() const;  // from this unit to that of the file, as unit_factor()
};
[[nodiscard]] std::span<const UserUnit> user_units();

// Numbers as people type them.
struct TypedNumbers {
  std::vector<std::string> texts;  // each a number
  std::string unit;                // of all; empty if none was typed
};
// Splits "140 deg", "45g", "0 0 -65 mm" or "1mm 2mm 3mm". Returns nothing for text that does not begin with a
// number, and for units that differ or follow some of the numbers only. Any word counts as a unit.
[[nodiscard]] std::optional<TypedNumbers> split_units(std::string_view text);

// Returns the factor from one unit to another of the same quantity; nothing if there is none. A unit converts
// to itself, also one that the program does not know. Spellings are equal that differ in blanks, in signs of
// multiplication, or as ° and deg, ² and ^2, µ and u do.
[[nodiscard]] std::optional<double> unit_factor(std::string_view from, std::string_view to);
// Returns the units that convert to this one, itself first.
[[nodiscard]] std::vector<std::string> units_for(std::string_view unit);
// Returns the text of a message for what is expected instead of a unit that does not convert: "the unit kg or
// g", or "no unit" for a key without a unit.
[[nodiscard]] std::string expected_unit(std::string_view unit);

// Parses one number, in this unit or with one that converts to it, and returns it in this unit. Returns
// nothing for other text.
[[nodiscard]] std::optional<double> parse_quantity(std::string_view text, std::string_view unit);

// Returns the unit that the end of a key of a YAML file, or of the key above it, names: "s" of duration_s,
// "m" of ground.position_m[1], "rad/s" of turn_rad_per_s, "deg" of joints_deg.left_knee. Empty if there is
// none.
[[nodiscard]] std::string unit_of_key(std::string_view path);

// Returns the unit that the author of implausible `values` had in mind, as a question for a message: "did you
// mean 45 g?". That is the first unit in which all values are plausible. Empty if there is none.
[[nodiscard]] std::string unit_question(std::span<const double> values, std::string_view unit_of_file,
                                        const std::function<bool(double)>& is_plausible);

}  // namespace koboshi
