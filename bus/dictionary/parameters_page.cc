#include "bus/dictionary/formats.h"

#include <fmt/format.h>

#include <iterator>
#include <optional>

#include "base/text/text.h"
#include "simulation/assembly/controller_parameters.h"

namespace koboshi::bus {
namespace {

constexpr std::string_view kParametersIntroduction =
    R"(# Parameters of the controller

These parameters of the controller can be set in the robot's parameter file, in a scenario, in a parameter
file of your own and in a study. The end of a key names the unit. [walking.md](../design/walking.md) explains
how the robot walks, and [getting-up.md](../design/getting-up.md) how it gets up. A client on the bus writes
the same parameters as integers: [object-dictionary.md](object-dictionary.md) has the scale of each object.
`koboshi dictionary write` generates this page.

## Precedence of values

1. The firmware's default is neutral: no feedback, no gait, no velocity, no fall detection. Without any other
   value the robot boots, stands and plays motions; the command to walk is refused with the reason `no gait`.
   An empty default means that the parameter is not set.
2. `parameters.yaml` beside the robot's file contains this robot's factory values. Every command that makes a
   storage image compiles it in; the firmware reads it at power-on and at a reset, and therefore also after
   restore default parameters (object 1011).
3. Values that a client has saved (object 1010) replace the factory values.
4. A scenario's `parameter_file` and `parameters`, and `--set parameters.KEY=VALUE`, are written by SDO at the
   start of a run.

```yaml
version: 1
robot: koboshi  # the name in the robot's file
parameters:
  lowest_supply_mV: 6000
  ramp_rate_deg_per_s: 60
```

The compiler refuses, with file and line, an unknown key, a value beyond its range, and what does not fit the robot's body: half a
gait, a posture or a step that the legs do not reach, soles that touch, a fall limit within the feet's edges or beyond 60 degrees,
a touchdown load above the robot's weight, supply limits out of order. Object 2200:0C tells whether the firmware took the item:
`none in storage`, `damaged`, `for another robot model` and `refused` leave all parameters neutral, the last three with an emergency
message of code 6300.

## All parameters

)";

std::string in_units(const simulation::Parameter& parameter, std::int64_t raw) {
  return fmt::format("{:.6g}", static_cast<double>(raw) / parameter.raw_per_unit());
}

// The value on the robot; empty if it is the default.
std::string robot_value_of(const simulation::Parameter& parameter, const std::string& default_value,
                           const app::ControllerValues& values) {
  const std::optional<double> value = simulation::value_in(values, parameter);
  std::string text = value ? fmt::format("{:.6g}", *value) : std::string();
  return text == default_value ? std::string() : text;
}

std::string default_of(const simulation::Parameter& parameter, const NodeKind& controller) {
  const ObjectItem* item = controller.find(parameter.address());
  const auto raw = item != nullptr ? parse_integer(item->default_value) : std::nullopt;
  return raw ? in_units(parameter, *raw) : std::string();
}

}  // namespace

std::string parameters_page_text(const NodeKind& controller, const std::string& robot,
                                 const app::ControllerValues& robot_values) {
  std::string page(kParametersIntroduction);
  fmt::format_to(std::back_inserter(page),
                 "| key | range | default | {} | object | takes effect | meaning |\n"
                 "| --- | --- | --- | --- | --- | --- | --- |\n",
                 robot);
  for (const simulation::Parameter& parameter : simulation::controller_parameters()) {
    const canopen::ObjectAddress address = parameter.address();
    const std::string default_value = default_of(parameter, controller);
    fmt::format_to(std::back_inserter(page), "| `{}` | {} to {} | {} | {} | {:04X}:{:02X} | {} | {} |\n",
                   parameter.key, in_units(parameter, parameter.low()), in_units(parameter, parameter.high()),
                   default_value, robot_value_of(parameter, default_value, robot_values), address.index,
                   address.subindex, parameter.effect(), parameter.object->text.comment);
  }
  return page;
}

}  // namespace koboshi::bus
