#pragma once

#include <cstdint>

namespace koboshi::cortex_m {

// Record of a fault in RAM that resets do not clear (section .noinit). It stays valid until it is cleared or
// power is lost.
struct FaultRecord {
  std::uint32_t exception = 0;      // 2 NMI, 3 hard, 4 memory, 5 bus, 6 usage fault; 16 and more an interrupt
  std::uint32_t r[13] = {};         // r0..r12 of the program
  std::uint32_t stack_pointer = 0;  // of the program; r0..r3, r12, lr, pc, xpsr are 0 if it pointed outside
                                    // RAM
  std::uint32_t link_register = 0;
  std::uint32_t program_counter = 0;
  std::uint32_t program_status = 0;
  std::uint32_t configurable_status = 0;  // CFSR
  std::uint32_t hard_status = 0;          // HFSR
  std::uint32_t memory_address = 0;       // MMFAR, valid by CFSR bit 7
  std::uint32_t bus_address = 0;          // BFAR, valid by CFSR bit 15
  std::uint32_t behaviour_state = 0;      // the last value of note_behaviour_state (behaviour::State)
  std::uint32_t drive_enable_line = 0;    // as read after the handler has pulled it low
};

// Returns the record of the fault that caused the last reset; null if the reset had another cause.
[[nodiscard]] const FaultRecord* last_fault();
// Forgets the record: last_fault() returns null from then on.
void clear_fault();
// Stores the state of the behaviour for the record of a fault.
void note_behaviour_state(std::uint32_t state);

// Sets the drive-enable line; defined by the board. Fault handlers call it, so it must not depend on any
// object.
void set_drive_enable_line(bool high);
[[nodiscard]] bool drive_enable_line();

}  // namespace koboshi::cortex_m
