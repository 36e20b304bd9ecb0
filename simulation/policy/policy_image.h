#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/policy/policy.h"

namespace koboshi::simulation {

// A layer of a policy, with its integers as the image has them.
struct PolicyLayer {
  std::size_t rows = 0;  // as the network has them; the image pads them
  std::size_t columns = 0;
  policy::Activation activation = policy::Activation::kLinear;
  int fraction_bits = policy::kMaxFractionBits;
  std::int32_t multiplier = 0;
  std::vector<std::int32_t> biases{};  // by row
  std::vector<std::int8_t> weights{};  // row by row, each within +-127
};

// The contents of a policy image.
struct PolicyContents {
  std::uint32_t model_id = 0;
  std::string name;
  std::uint8_t patience_ticks = 1;
  std::vector<policy::Input> inputs{};
  std::vector<policy::Output> outputs{};
  std::vector<PolicyLayer> layers{};
};

// Returns the image (docs/reference/policy.md), without a check of its values: Policy::open() does that. Rows
// and columns are padded with zeros. Requires layers whose columns are the rows of the layer before.
[[nodiscard]] std::vector<std::byte> make_policy_image(const PolicyContents& contents);

}  // namespace koboshi::simulation
