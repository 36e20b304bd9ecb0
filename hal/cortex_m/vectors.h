#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>

namespace koboshi::cortex_m {

// A handler of an exception or an interrupt: an ordinary function, since the core saves the registers that a
// call may change (ARMv7-M, B1.5.6).
using Handler = void (*)();

// Records the fault, pulls the drive-enable line low and resets the core (fault.h). Handles every exception
// and interrupt that has no handler of its own.
extern "C" void fault_handler();

// The handler of the SysTick exception. The default, fault_handler, is weak: a program that lets SysTick
// raise it (SysTick::start_interrupt) defines this function. Define it in a source of the program itself,
// because a linker does not search static libraries for a replacement of a weak symbol.
extern "C" void systick_handler();

// The handler of one interrupt, by its number in the part's reference manual (0 is the first after the core's
// exceptions).
struct Interrupt {
  std::size_t number;
  Handler handler;
};

// Returns the vectors of a part with kCount interrupts; fault_handler where `installed` has no handler. A
// number that is out of range does not compile. The board or its program places the result behind the vectors
// of the core, and enables the interrupts in the NVIC:
//
//   [[gnu::section(".vectors.interrupts"), gnu::used]] constinit const auto vectors =
//       interrupt_vectors<82>({{20, can_handler}});
template <std::size_t kCount>
consteval std::array<Handler, kCount> interrupt_vectors(std::initializer_list<Interrupt> installed = {}) {
  std::array<Handler, kCount> vectors{};
  vectors.fill(fault_handler);
  for (const Interrupt& interrupt : installed) vectors.at(interrupt.number) = interrupt.handler;
  return vectors;
}

}  // namespace koboshi::cortex_m
