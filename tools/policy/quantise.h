#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "simulation/model/robot_model.h"
#include "simulation/policy/policy_image.h"
#include "tools/policy/mlp.h"
#include "tools/policy/policy_map.h"

namespace koboshi::tools {

// Difference of the quantised policy from the network in floating point, in an output's offset.
struct QuantisationError {
  double largest_rad = 0.0;
  double rms_rad = 0.0;
  double range_rad = 0.0;  // largest offset of the network
};

struct QuantisedPolicy {
  std::vector<std::byte> image;
  std::uint32_t work = 0;                 // instructions of the Cortex-M4 in a cycle, at most
  std::size_t weights = 0;                // of the image, padding included
  std::vector<QuantisationError> errors;  // by output, over the recorded inputs
  std::size_t clamped_rows = 0;           // recorded rows with an output beyond its bound
};

// Makes an image of a network: weights of 8 bits with one scale for each layer, activations of 16 bits.
// Ranges of inputs and activations are those of the recorded rows, in SI units, in the order of the map's
// inputs. Throws InputError, in which `onnx` is the source, if network and map do not fit, or the firmware
// refuses the result.
[[nodiscard]] QuantisedPolicy quantise(const Mlp& network, const PolicyMap& map,
                                       const std::vector<std::vector<double>>& rows,
                                       const simulation::NamedModel& robot,
                                       const std::filesystem::path& onnx);

}  // namespace koboshi::tools
