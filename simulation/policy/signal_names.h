#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi::simulation {

// A signal of a policy by its name.
struct SignalName {
  std::string name;         // roll, left_knee.angle, output.left_hip_roll
  std::uint8_t signal = 0;  // policy::Signal, with its place
  double unit = 0.0;        // of the signal's integer, in SI units
  std::string_view symbol;  // of the SI unit; empty for a number
};

// Returns all signals of a robot whose joints have these names. The outputs are those of the policy, by their
// joints.
[[nodiscard]] std::vector<SignalName> signal_names(std::span<const std::string> joints,
                                                   std::span<const std::string> outputs);

}  // namespace koboshi::simulation
