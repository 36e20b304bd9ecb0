#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace koboshi::sim {

// A unit in which people write a quantity whose unit in files is another.
struct UserUnit {
  std::string_view name;     // "g"
  std::string_view of_file;  // "kg"
  double factor;             // from this unit to that of the file
  double rounding;           // of the file's value, as in files written by hand
  bool is_shown;             // the one in which editors show the quantity
};
[[nodiscard]] std::span<const UserUnit> user_units();

// The rule for numbers: without a unit they are in the unit of the file. Returns the unit that the author of
// implausible `values` had in mind, as a question for a message: "did you mean 45 g?". That is the first unit
// in which all values are plausible. Empty if there is none.
[[nodiscard]] std::string unit_question(std::span<const double> values, std::string_view unit_of_file,
                                        const std::function<bool(double)>& is_plausible);

}  // namespace koboshi::sim
