#pragma once

#include <string>

namespace koboshi::hal {

// The kernel's number of a network interface. Throws std::system_error when there is no such interface.
[[nodiscard]] int interface_index(const std::string& interface);

// What made a network interface, as `ip -details link` says it: "vcan", "vxcan", "slcan"; empty for real
// hardware. Throws std::system_error when there is no such interface, or the kernel does not tell.
[[nodiscard]] std::string interface_kind(const std::string& interface);

// Whether what is sent there can move nothing real: vcan and vxcan.
[[nodiscard]] bool is_virtual_can(const std::string& interface);

}  // namespace koboshi::hal
