#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "simulation/motion_language/parse/sensors.h"

namespace koboshi::tools {

// A sensor as an expression names it.
struct SensorText {
  std::string sensor;
  std::string joint{};       // of a sensor of a joint
  bool is_opposite = false;  // the value has the other sign
};

// Returns a condition or number of the motion language with its sensors replaced; everything else, spaces and
// quotes included, stays. `image` gets each sensor, and the joint in brackets behind a sensor of a joint.
[[nodiscard]] std::string replace_sensors(
    std::string_view text,
    const std::function<SensorText(const simulation::Sensor& sensor, std::string_view joint)>& image);

}  // namespace koboshi::tools
