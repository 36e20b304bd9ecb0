#include "hal/cortex_m/vectors.h"

namespace koboshi::cortex_m {
namespace {

// The image enables none of the 32 interrupts of the board.
[[gnu::section(".vectors.interrupts"), gnu::used]] constinit const auto vectors = interrupt_vectors<32>();

}  // namespace
}  // namespace koboshi::cortex_m
