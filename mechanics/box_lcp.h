#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/lanes.h"

namespace koboshi::mechanics {

// Solves the linear complementarity problem with bounds: x and w = A x - b such that for each row
//   lower <= x <= upper,  w >= 0 where x = lower,  w <= 0 where x = upper,  w = 0 between,
// for a symmetric positive definite A. It is the optimality condition of: minimise x'Ax/2 - b'x within the
// bounds. The method is the primal active-set method (Nocedal and Wright, "Numerical Optimization", 2006,
// algorithm 16.3): rows are free or held at a bound; the free ones are solved by Cholesky factorisation; x
// moves towards that solution until a row reaches a bound and is held there; at the solution, the row that
// violates its condition most is released. The objective falls from one release to the next, so that no set
// of held rows repeats. The solution is unique; only its rounding depends on the start.
class BoxLcp {
 public:
  // Either may be infinite. Equal bounds fix x for any w.
  struct Bounds {
    double lower;
    double upper;
  };

  // Position of x: between its bounds, at one of them, or at both because they are equal.
  enum class Side : char { kFree, kLower, kUpper, kFixed };

  // Allocates memory for this number of rows. More are allocated when needed.
  explicit BoxLcp(std::size_t rows);

  // Starts a problem with this number of rows. The caller then writes A(), b(), bounds(), sides() and x().
  // Bounds, sides and x may be changed for another solution with the same A and b.
  void resize(std::size_t rows);
  // Row by row.
  std::span<double> A() { return {A_.data(), rows_ * rows_}; }
  std::span<double> b() { return {b_.data(), rows_}; }
  std::span<Bounds> bounds() { return bounds_; }
  // Where the search starts, and after it, the solution. A start near the solution saves time.
  std::span<Side> sides() { return sides_; }
  std::span<double> x() { return {x_.data(), rows_}; }
  std::span<const double> x() const { return {x_.data(), rows_}; }

  // Returns false if A is not positive definite or, because of rounding, the search does not end; x() is then
  // no solution.
  [[nodiscard]] bool solve();

  // Number of solutions for the free rows so far, for measurements.
  std::uint64_t iterations() const { return iterations_; }

 private:
  void begin();
  bool factorise();
  void factorise_together(std::size_t first);
  bool factorise_row(std::size_t row, std::size_t first);
  bool solve_free();
  // Moves x towards the solution of the free rows. Returns false if a row reached a bound, which then holds
  // it.
  bool move();
  // Releases the row that violates its condition most. Returns false if none does.
  bool release();
  void hold(std::size_t place, Side side);

  std::size_t rows_ = 0;
  std::vector<double> A_;
  std::vector<double> b_;
  std::vector<Bounds> bounds_;
  std::vector<double> x_;
  std::vector<Side> sides_;
  // Free rows, and their Cholesky factor, row by row with rows_ elements each. A row of the factor depends on
  // those before it: rows that are released are appended, and of the factor only the rows from the first
  // change on are computed again.
  std::vector<std::size_t> free_;
  std::vector<double> factor_;
  std::vector<double> diagonal_inverse_;
  std::size_t factorised_ = 0;
  std::vector<Lanes> together_;  // elements of four rows of the factor, by column
  std::vector<double> free_x_;   // solution of the free rows, in their order
  std::uint64_t iterations_ = 0;
};

}  // namespace koboshi::mechanics
