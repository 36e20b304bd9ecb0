#pragma once

#include "sim_board/input/xml_schema.h"

namespace koboshi::sim {

// The part of SDF 1.9 that a robot may use, with the koboshi: elements that SDF lacks. What this rule does
// not name would have no effect on the simulation, so that it is an error.
const XmlRule& sdf_rule();
// A file of servo types that robot files may take over (robots/servos).
const XmlRule& servo_library_rule();

}  // namespace koboshi::sim
