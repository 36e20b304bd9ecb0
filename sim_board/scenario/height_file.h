#pragma once

#include <filesystem>

#include "sim_board/world/ground.h"

namespace koboshi::sim {

// The most points along one side of a height field: more than enough for a robot's world, and few enough to
// be searched.
inline constexpr int kMaxHeightPoints = 1000;

// The heights of a grid from a text file:
//
//   plain PGM (P2)   an image: from 0, black, to 1, the brightest grey that the file allows
//   anything else    comma-separated: a line for each row, a number for each point, as many in each line
//
// Seen from above with x to the right and y up the page: the first line is the row of the highest y.
struct HeightFile {
  bool is_image = false;
  HeightField field;  // columns, rows and heights only
};
// Throws InputError.
HeightFile read_height_file(const std::filesystem::path& file);

}  // namespace koboshi::sim
