#pragma once

#include <string>
#include <vector>

#include "simulation/scenario/reader.h"

namespace koboshi::studio {

// A robot that walks forward from 4.2 s on, for as long as the test lets it.
inline simulation::Scenario sample_walk() {
  const std::vector<Override> overrides{
      {"physics.stepper", "lumped"},
      {"duration_s", "20"},
      {"initial.held_until_s", "3.2"},
      {"commands",
       "[{at_s: 2, enable: true}, {at_s: 3.4, walk: {}}, {at_s: 4.2, walk: {forward_m_per_s: 0.2}}]"}};
  return simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/go.yaml", overrides);
}

}  // namespace koboshi::studio
