#include "studio/document/neighbours.h"

#include <map>

namespace koboshi::studio {
namespace {

// By row of each branch around a step, whether it is in its `else`.
std::map<std::size_t, bool> sides_of(const MotionRows& rows, std::size_t row) {
  std::map<std::size_t, bool> sides;
  for (const MotionRow* at = &rows.rows[row]; at->parent; at = &rows.rows[*at->parent])
    if (rows.rows[*at->parent].kind == simulation::StepSource::Kind::kIf) sides[*at->parent] = at->in_else;
  return sides;
}

}  // namespace

NeighbouringMoves neighbouring_moves(const MotionRows& rows, std::size_t row, std::size_t most_before,
                                     std::size_t most_after) {
  NeighbouringMoves moves;
  if (row >= rows.rows.size()) return moves;
  const std::map<std::size_t, bool> own = sides_of(rows, row);
  const auto is_on_path = [&](std::size_t other) {
    if (rows.rows[other].kind != simulation::StepSource::Kind::kMove) return false;
    for (const auto& [branch, in_else] : sides_of(rows, other)) {
      const auto side = own.find(branch);
      if (in_else != (side != own.end() && side->second)) return false;
    }
    return true;
  };
  const MotionSection& section = rows.sections[rows.rows[row].section];
  for (std::size_t i = row; i > section.first_row && moves.before.size() < most_before; --i)
    if (is_on_path(i - 1)) moves.before.push_back(i - 1);
  const std::size_t end = section.first_row + section.row_count;
  for (std::size_t i = row + 1; i < end && moves.after.size() < most_after; ++i)
    if (is_on_path(i)) moves.after.push_back(i);
  return moves;
}

}  // namespace koboshi::studio
