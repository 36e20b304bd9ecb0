#pragma once

#include "firmware/motion/instructions.h"
#include "simulation/motion_language/parse/reader.h"

namespace koboshi::simulation {

// Parses the map of a step `expect`. Returns whether it is free of errors, which it reports.
bool parse_expect(const YamlNode& value, int version, Reader& reader, motion::ExpectedAttitude& attitude);

}  // namespace koboshi::simulation
