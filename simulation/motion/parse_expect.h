#pragma once

#include "firmware/motion/instructions.h"
#include "simulation/motion/reader.h"

namespace koboshi::simulation {

// Parses the map of a step `expect`. Returns whether it is free of errors, which it reports.
bool parse_expect(const sim::YamlNode& value, int version, Reader& reader,
                  motion::ExpectedAttitude& attitude);

}  // namespace koboshi::simulation
