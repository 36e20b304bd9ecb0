#pragma once

#include "sim_board/input/xml_reader.h"

namespace koboshi::sim {

// Checks a model before libsdformat reads it, which would correct errors silently or report them without a
// line: duplicate names, references to missing links and frames, inertias of no rigid body, joints that are
// not hinges, axes that are not unit vectors. Throws InputError.
void check_model(const XmlNode& model);

}  // namespace koboshi::sim
