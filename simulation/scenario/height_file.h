#pragma once

#include <filesystem>

#include "sim_board/world/ground.h"

namespace koboshi::simulation {

// Maximum number of points along a side of a height field: ample for a robot's world, and small enough for
// searches.
inline constexpr int kMaxHeightPoints = 1000;

// Heights of a grid from a text file:
//
//   plain PGM (P2)   an image: 0 (black) is the lowest, the file's maximum grey value is 1
//   anything else    comma-separated: one line per row, one number per point, the same count in each line
//
// In plan view with x to the right and y up, the first line is the row of highest y.
struct HeightFile {
  bool is_image = false;
  sim_board::HeightField field;  // only columns, rows and heights are set
};
// Throws InputError.
HeightFile read_height_file(const std::filesystem::path& file);

}  // namespace koboshi::simulation
