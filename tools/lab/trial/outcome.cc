#include "tools/lab/trial/outcome.h"

namespace koboshi::tools {

std::vector<Measure> outcome_measures() {
  using enum Measure::Kind;
  return {{.name = "fell", .kind = kEvent, .label = "falls"},
          {.name = "gave_up", .kind = kEvent, .label = "given up"},
          {.name = "low_supply", .kind = kEvent, .label = "low supply"},
          {.name = "energy_guard", .kind = kEvent, .label = "energy guard"},
          {.name = "failed", .kind = kEvent}};
}

void add_outcome(const Values& played, Values& values) {
  values.error = played.error;
  values[kLost] = played.at(kLost);
  for (const Measure& measure : outcome_measures()) values[measure.name] = played.at(measure.name);
}

}  // namespace koboshi::tools
