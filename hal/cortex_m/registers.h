#pragma once

#include <cstdint>

namespace koboshi::cortex_m {

// The registers of the core's private peripherals that the image uses (ARMv7-M Architecture Reference Manual,
// B3.2).
struct Registers {
  static volatile std::uint32_t& at(std::uint32_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
  }

  static volatile std::uint32_t& systick_control() { return at(0xE000'E010); }
  static volatile std::uint32_t& systick_reload() { return at(0xE000'E014); }
  static volatile std::uint32_t& systick_value() { return at(0xE000'E018); }
  // Bit n of word i is interrupt 32 i + n.
  static volatile std::uint32_t& interrupt_enable(std::uint32_t i) { return at(0xE000'E100 + 4 * i); }
  static volatile std::uint32_t& interrupt_pending(std::uint32_t i) { return at(0xE000'E200 + 4 * i); }
  static volatile std::uint32_t& interrupt_control() { return at(0xE000'ED04); }
  static volatile std::uint32_t& reset_control() { return at(0xE000'ED0C); }
  static volatile std::uint32_t& handler_control() { return at(0xE000'ED24); }
  static volatile std::uint32_t& configurable_fault_status() { return at(0xE000'ED28); }
  static volatile std::uint32_t& hard_fault_status() { return at(0xE000'ED2C); }
  static volatile std::uint32_t& memory_fault_address() { return at(0xE000'ED34); }
  static volatile std::uint32_t& bus_fault_address() { return at(0xE000'ED38); }
  static volatile std::uint32_t& protection_control() { return at(0xE000'ED94); }
  static volatile std::uint32_t& protection_base() { return at(0xE000'ED9C); }
  static volatile std::uint32_t& protection_attributes() { return at(0xE000'EDA0); }
};

}  // namespace koboshi::cortex_m
