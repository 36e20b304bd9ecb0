#pragma once

#include <optional>

#include "tools/import/pipeline/import_robot.h"

namespace koboshi::tools {

// Imports a URDF that `koboshi model export` wrote, unless the interview decides otherwise: its robot's file
// is taken as it is, with the values that were changed in the URDF. Returns nothing for another file, or for
// one whose robot's file is not used, which is a warning of the report.
[[nodiscard]] std::optional<ImportResult> import_exported(const ImportOptions& options, Interview& interview,
                                                          ImportReport& report);

}  // namespace koboshi::tools
