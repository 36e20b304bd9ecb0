#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace koboshi::simulation {

// Returns the factory contents of a robot's storage: the catalogue (firmware/storage/catalogue.h), the images
// of the RobotModel and of the motions, where the i-th becomes motion i, and the images of the robot's
// parameters and of the policy unless they are empty.
[[nodiscard]] std::vector<std::byte> make_storage_contents(std::span<const std::byte> model,
                                                           std::span<const std::vector<std::byte>> motions,
                                                           std::span<const std::byte> parameters = {},
                                                           std::span<const std::byte> policy = {});

}  // namespace koboshi::simulation
