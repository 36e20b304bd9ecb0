#pragma once

#include <set>
#include <string>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"

namespace koboshi::tools {

// The names of all links and joints of a robot.
[[nodiscard]] std::set<std::string> names_in(const ImportedRobot& robot);

// Throws InputError for a decision with a name that neither the source nor any robot made of it can have:
// what can be found before the first question. `source` is named of decisions without a place.
void require_known_names(const ImportDecisions& given, const ImportedRobot& robot,
                         const std::filesystem::path& source);

// Throws InputError for a decision about something that neither the source, with the links and joints
// `source_names`, nor the robot made of it has: a misspelt name would have no effect. Answers to questions
// that this import does not ask are permitted, since another one may.
void require_known(const ImportDecisions& given, const ImportDecisions& taken,
                   const std::set<std::string>& source_names, const ImportedRobot& robot,
                   const std::filesystem::path& source);

}  // namespace koboshi::tools
