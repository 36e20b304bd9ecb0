#pragma once

#include <string>

namespace koboshi::hal {

// Returns the kernel's index of a network interface. Throws std::system_error if there is no such interface.
[[nodiscard]] int interface_index(const std::string& interface);

// Returns the kind of a network interface, as `ip -details link` shows it: "vcan", "vxcan", "slcan"; empty
// for real hardware. Throws std::system_error if there is no such interface or the kernel does not answer.
[[nodiscard]] std::string interface_kind(const std::string& interface);

// Returns whether the interface is virtual (vcan, vxcan): frames sent there cannot move a real servo.
[[nodiscard]] bool is_virtual_can(const std::string& interface);

}  // namespace koboshi::hal
