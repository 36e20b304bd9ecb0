#pragma once

#include <filesystem>

namespace koboshi::sim {

// The folder of a run is written in place, so that a run that fails leaves what it recorded and a running one
// can be watched. Check it with all other input, before anything is computed; make it when all input has
// proved good.

// Throws InputError unless a run may write there: the path is free, or an empty folder, or one that an
// earlier run left (with summary.json, or with the trace.csv and can.log of one that was cut short) and that
// has no folder in it but `figures`. Touches nothing.
void check_output_folder(const std::filesystem::path& folder);

// Checks again, then makes the folder, or empties it of the earlier run. Throws InputError or
// std::filesystem::filesystem_error.
void make_output_folder(const std::filesystem::path& folder);

}  // namespace koboshi::sim
