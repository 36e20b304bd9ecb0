#pragma once

#include <cstdint>
#include <span>

namespace koboshi::bench {

// A numeric kernel, as a function of two numbers in its own format; most use one.
using Kernel = std::uint32_t (*)(std::uint32_t, std::uint32_t);

struct Contestant {
  const char* name;
  Kernel kernel;
  // Turns a fraction, 32 bits for [0, 1), into an argument from the kernel's domain.
  Kernel argument;
};

// Sine, cosine, arc tangent, root, product, quotient and filter, in this order and on the same domains.
std::span<const Contestant, 7> fixed_kernels();
std::span<const Contestant, 7> float_kernels();

}  // namespace koboshi::bench
