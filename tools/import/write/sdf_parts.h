#pragma once

#include <filesystem>
#include <string>

namespace koboshi::tools {

// Returns the link or joint of an SDF file in which a line is: "joint left_knee". Empty if the line is in
// neither, as line 0 is.
[[nodiscard]] std::string part_at_line(const std::filesystem::path& sdf, int line);

}  // namespace koboshi::tools
