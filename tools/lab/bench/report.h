#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/lab/bench/bench.h"

namespace koboshi::tools {

// A line for each stepper, for people.
std::string bench_table(const std::vector<BenchResult>& results);

// At the top level the figures of the fastest accurate ODE stepper, null where there is none; all under
// `steppers`, by name. docs/reference/bench.md names the keys.
nlohmann::ordered_json bench_json(const std::vector<BenchResult>& results);

}  // namespace koboshi::tools
