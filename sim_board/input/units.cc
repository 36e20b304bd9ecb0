#include "sim_board/input/units.h"

#include <algorithm>
#include <array>

#include "sim_board/input/text.h"
#include "sim_board/input/user_units.h"

namespace koboshi::sim {

std::span<const UserUnit> user_units() {
  static constexpr std::array kUnits = {
      UserUnit{"mm", "m", 1e-3, 1e-9, true},
      UserUnit{"cm", "m", 1e-2, 1e-9, false},
      UserUnit{"deg", "rad", kRadPerDegree, 1e-6, true},
      UserUnit{"g", "kg", 1e-3, 1e-9, true},
      UserUnit{"deg/s", "rad/s", kRadPerDegree, 1e-6, true},
      UserUnit{"g cm^2", "kg m^2", 1e-7, 1e-13, true},
      UserUnit{"ms", "s", 1e-3, 1e-9, true},
  };
  return kUnits;
}

std::string unit_question(std::span<const double> values, std::string_view unit_of_file,
                          const std::function<bool(double)>& is_plausible) {
  for (const UserUnit& unit : user_units()) {
    if (unit.of_file != unit_of_file) continue;
    if (!std::ranges::all_of(values, [&](double value) { return is_plausible(value * unit.factor); }))
      continue;
    std::string text = "did you mean ";
    for (const double value : values) text += number_text(value) + " ";
    return text + std::string(unit.name) + "?";
  }
  return {};
}

}  // namespace koboshi::sim
