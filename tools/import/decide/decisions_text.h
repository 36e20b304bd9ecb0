#pragma once

#include <filesystem>
#include <string>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Returns the text of import.yaml: what was decided, with the questions and the reasons as comments. Reading
// it gives the same decisions. `source` is written as it is.
[[nodiscard]] std::string decisions_text(const Interview& interview, const ImportReport& report,
                                         const std::filesystem::path& source);

}  // namespace koboshi::tools
