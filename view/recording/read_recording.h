#pragma once

#include <filesystem>

#include "view/recording/recording.h"

namespace koboshi::view {

// Reads a recording: a run's folder, or its file run.mcap. One that was interrupted is read up to its last
// whole block and is marked as not complete. Throws InputError for a file that is no recording, that is
// damaged, or that ends within its first block.
Recording read_recording(const std::filesystem::path& run);

}  // namespace koboshi::view
