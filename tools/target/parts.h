#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace koboshi::tools {

// The parts of the firmware for which the report counts instructions.
enum class Part : std::size_t { kSensors, kEstimation, kBehaviour, kInterpreter, kCanopen, kDrives };
inline constexpr std::array<const char*, 6> kPartNames{"sensors",     "estimation", "behaviour",
                                                       "interpreter", "canopen",    "drives"};

// Returns the part of a function, by its name without parameters and without namespace koboshi. Nothing for
// arithmetic, ports and the compiler's library: their instructions belong to their callers.
[[nodiscard]] std::optional<Part> part_of(std::string_view function);

}  // namespace koboshi::tools
