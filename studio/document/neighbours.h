#pragma once

#include <cstddef>
#include <vector>

#include "studio/document/motion_rows.h"

namespace koboshi::studio {

// Moves around a step, as rows, the nearest first.
struct NeighbouringMoves {
  std::vector<std::size_t> before;
  std::vector<std::size_t> after;
};

// Returns up to this many moves before and after a row in its section, in the order of the file. A branch
// around them contributes those of the side on which the row is, another one those of `then`, which the
// nominal path plays.
[[nodiscard]] NeighbouringMoves neighbouring_moves(const MotionRows& rows, std::size_t row,
                                                   std::size_t most_before, std::size_t most_after);

}  // namespace koboshi::studio
