#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "simulation/gait/gait.h"

namespace koboshi::simulation {

// A number of a gait file (docs/reference/gait-format.md, which repeats units, ranges and meanings).
struct GaitKey {
  std::string_view key = {};   // dotted: feedback.knee_s
  std::string_view unit = {};  // empty: without one
  double min = 0.0;
  double max = 0.0;
  std::optional<double> fallback = {};  // without the key; nothing: the file must have it
  bool is_integer = false;
  std::string_view meaning = {};
  void (*set)(Gait& gait, double value) = nullptr;
};

// All numbers of the file except the angles of the upper body, in the order of the reference page.
std::span<const GaitKey> gait_keys();

}  // namespace koboshi::simulation
