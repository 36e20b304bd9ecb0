#pragma once

#include "sim_board/input/xml_reader.h"

namespace koboshi::sim {

// What can be told of a model before libsdformat reads it, which would correct it in silence or complain
// without a line: names used twice, names of links and frames that do not exist, inertias of no rigid body,
// joints that are no hinges, axes that are no unit vectors. Throws InputError.
void check_model(const XmlNode& model);

}  // namespace koboshi::sim
