#pragma once

#include <cstddef>

namespace koboshi::mechanics {

// Four doubles on which an operator works at once. They are values within a function; neither parameters nor
// results, whose registers depend on the processor.
using Four = double __attribute__((vector_size(32)));
// The same anywhere in an array of doubles.
using LooseFour = double __attribute__((vector_size(32), aligned(8), may_alias));

inline const LooseFour& four_at(const double* first) { return *reinterpret_cast<const LooseFour*>(first); }
inline LooseFour& four_at(double* first) { return *reinterpret_cast<LooseFour*>(first); }

// Four numbers that the same operations are applied to, such as the same element of four rows. The alignment
// is that of processors with such registers; for others, GCC aligns the type to less by itself.
struct alignas(32) Lanes {
  static constexpr std::size_t kCount = 4;
  Four all = {};

  double& operator[](std::size_t lane) { return reinterpret_cast<double*>(&all)[lane]; }
  double operator[](std::size_t lane) const { return reinterpret_cast<const double*>(&all)[lane]; }
};
static_assert(alignof(Lanes) == sizeof(Four));

}  // namespace koboshi::mechanics
