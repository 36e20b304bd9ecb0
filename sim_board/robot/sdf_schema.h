#pragma once

#include "sim_board/input/xml_schema.h"

namespace koboshi::sim {

// Rule for the subset of SDF 1.9 that a robot may use, plus the koboshi: elements. Elements without a rule
// are errors, because they would have no effect on the simulation.
const XmlRule& sdf_rule();
// Rule for a library of servo types, which robot files can import (robots/servos).
const XmlRule& servo_library_rule();

}  // namespace koboshi::sim
