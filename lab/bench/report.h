#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lab/bench/bench.h"

namespace koboshi::lab {

// A table with a line for each stepper.
std::string bench_table(const std::vector<BenchResult>& results);

// The figures of the fastest accurate ODE stepper at the top level, null if there is none; those of all
// steppers under `steppers`, by name. docs/reference/bench.md names the keys.
nlohmann::ordered_json bench_json(const std::vector<BenchResult>& results);

}  // namespace koboshi::lab
