#pragma once

#include "base/text/error.h"
#include "base/xml/xml_schema.h"

namespace koboshi::sim_board {

// The table of a robot file's keys, from which the reader, docs/reference/robot-file.md, robot.xsd and the
// editor's tooltips come. robot_keys.h has the same as a list.

// Name space of the koboshi: elements. It is no address.
inline constexpr const char* kKoboshiNamespace = "https://koboshi.invalid/sdf";

// Rule for the subset of SDF 1.5 to 1.9 that a robot may use, plus the koboshi: elements. Elements without a
// rule are errors, because they would have no effect on the simulation.
const XmlRule& sdf_rule();
// Rule for a library of servo types, which robot files can import (robots/servos).
const XmlRule& servo_library_rule();

// Returns an error of reading a robot's file, for the caller to throw: for a file of another format (URDF,
// MJCF), one that says how to import it instead.
InputError with_import_advice(const InputError& error);

}  // namespace koboshi::sim_board
