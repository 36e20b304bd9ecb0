#pragma once

#include <array>
#include <string>

namespace koboshi::studio {

// A ground that the run panel offers: pieces of ground (docs/reference/ground.md) in front of the robot with
// one number to choose.
struct Terrain {
  enum class Kind { kScenario, kPlane, kMat, kSteps, kRamp, kSlippery, kRough };

  Kind kind = Kind::kScenario;
  const char* name = "";   // to be translated
  const char* value = "";  // what the number means, to be translated; empty: there is none
  const char* unit = "";
  double lowest = 0.0;
  double highest = 0.0;
  double usual = 0.0;
  int decimals = 0;
};

// The first one leaves the pieces of the scenario as they are.
const std::array<Terrain, 7>& terrains();

// The list `ground.shapes` of a scenario in YAML's flow style: the ground begins 0.3 m ahead of the robot's
// start and is 1 m wide. Must not be called for kScenario.
std::string terrain_shapes(Terrain::Kind kind, double value);

}  // namespace koboshi::studio
