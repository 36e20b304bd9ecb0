#pragma once

#include <filesystem>
#include <string>

namespace koboshi::tools {

// Returns a motion file in its canonical layout: one pose and one step a line in flow style, loops, branches
// and routines as blocks, comments and the order of keys as they were. Formatting twice changes nothing more.
// Throws InputError for text that is no YAML, or no motion of version 1 or 2.
[[nodiscard]] std::string format_motion(const std::filesystem::path& source, const std::string& text);

// Returns a file of version 1 as one of version 2 that compiles to the same image, with all comments. A file
// of version 2 is returned as it is.
[[nodiscard]] std::string upgrade_motion(const std::filesystem::path& source, const std::string& text);

}  // namespace koboshi::tools
