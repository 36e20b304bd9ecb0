#pragma once

#include <filesystem>
#include <string>

#include "sim_board/description/description.h"

namespace koboshi::tools {

// Simulates a servo on a test bench and draws each result, with its data (CSV, PNG, SVG), into `folder`:
//
//   torque_speed    speed, current and power over the load, at full duty
//   step            a step of the target, with an inertia like the rotor's
//   sine            a sine of the target under a weight that goes up and down
//   friction_speed  the bound on dry friction over the speed, for several loads
//   friction_load   the same over the load; the largest load that the motor lifts, the smallest that drives
//   it back backlash        the shaft under an alternating external torque while the servo holds its position
//
// Makes the folder. Throws WriteError and PlotError.
void draw_servo(const std::string& name, const sim_board::ServoDescription& servo,
                const std::filesystem::path& folder);

}  // namespace koboshi::tools
