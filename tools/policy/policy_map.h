#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "simulation/model/robot_model.h"

namespace koboshi::tools {

// An input of the network, by the signal of the robot that it is: signal * scale + offset.
struct MappedInput {
  std::string name;         // of the signal
  std::uint8_t signal = 0;  // its place in policy::Signals
  double unit = 0.0;        // of the signal's integer, in SI units
  double scale = 1.0;
  double offset = 0.0;
  std::optional<std::pair<double, double>> range{};  // of the signal, in SI units; else the recorded one
  std::string column;                                // of the recording
  double column_scale = 1.0;                         // from the recording to SI units
};

// An output of the network: an offset of `scale_rad` times it.
struct MappedOutput {
  std::string joint;
  std::uint8_t index = 0;
  double scale_rad = 0.0;
  double bound_rad = 0.0;
  double rate_rad_per_s = 0.0;
};

// How the inputs and outputs of a network are those of a robot (docs/reference/policy.md).
struct PolicyMap {
  std::string name;
  std::string onnx_output{};  // empty: the first
  std::uint8_t patience_ticks = 5;
  double margin = 0.1;  // added to each end of a recorded range, as a share of its width
  std::vector<MappedInput> inputs{};
  std::vector<MappedOutput> outputs{};
};

// Reads a map. Throws InputError with file and line.
[[nodiscard]] PolicyMap read_policy_map(const std::filesystem::path& file,
                                        const simulation::NamedModel& robot);

}  // namespace koboshi::tools
