#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace koboshi::tools {

// The parts of the firmware whose instructions the report tells apart.
enum class Part : std::size_t { kSensors, kEstimation, kBehaviour, kInterpreter, kCanopen, kDrives };
inline constexpr std::array<const char*, 6> kPartNames{"sensors",     "estimation", "behaviour",
                                                       "interpreter", "canopen",    "drives"};

// The part that a function belongs to, by its name without parameters and without namespace koboshi. Nothing
// for arithmetic, ports and the compiler's library: they work for whoever calls them.
[[nodiscard]] std::optional<Part> part_of(std::string_view function);

}  // namespace koboshi::tools
