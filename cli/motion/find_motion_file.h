#pragma once

#include <filesystem>

namespace koboshi::cli {

// Resolves a motion given on the command line (simulation::find_motion). Throws InputError for a motion file
// of another maker, with the command that imports it.
[[nodiscard]] std::filesystem::path find_motion_file(const std::filesystem::path& given,
                                                     const std::filesystem::path& robot);

}  // namespace koboshi::cli
