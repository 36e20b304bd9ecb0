#include "simulation/motion_language/parse/sensors.h"

#include <algorithm>

namespace koboshi::simulation {

const Sensor* find_sensor(std::string_view name) {
  const auto found = std::find_if(kSensors.begin(), kSensors.end(),
                                  [&](const Sensor& sensor) { return sensor.name == name; });
  return found == kSensors.end() ? nullptr : &*found;
}

const Sensor* find_sensor(motion::Source source) {
  const auto found = std::find_if(kSensors.begin(), kSensors.end(),
                                  [&](const Sensor& sensor) { return sensor.source == source; });
  return found == kSensors.end() ? nullptr : &*found;
}

}  // namespace koboshi::simulation
