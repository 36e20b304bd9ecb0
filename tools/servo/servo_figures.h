#pragma once

#include <filesystem>
#include <string>

#include "sim_board/robot/description.h"

namespace koboshi::tools {

// What a servo does on a test bench, each as a table and a figure (CSV, PNG, SVG) in `folder`, which is made:
//
//   torque_speed    speed, current and power over the load that the servo drives, at its whole duty
//   step            a step of the target, with an inertia like the rotor's
//   sine            a sine of the target under a weight that goes up and down
//   friction_speed  the bound on dry friction over the speed, for several loads
//   friction_load   the same over the load; the load that the motor just lifts, and that just drives it back
//   backlash        the shaft under an outer torque that comes and goes while the servo holds its position
//
// Throws std::system_error, PlotError.
void draw_servo(const std::string& name, const sim::ServoDescription& servo,
                const std::filesystem::path& folder);

}  // namespace koboshi::tools
