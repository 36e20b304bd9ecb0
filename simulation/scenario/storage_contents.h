#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace koboshi::simulation {

// What a robot's storage holds when it leaves the factory: catalogue (firmware/storage/catalogue.h),
// RobotModel image, motion images, the i-th as motion i, and, unless it is empty, the image of the robot's
// parameters.
[[nodiscard]] std::vector<std::byte> make_storage_contents(std::span<const std::byte> model,
                                                           std::span<const std::vector<std::byte>> motions,
                                                           std::span<const std::byte> parameters = {});

}  // namespace koboshi::simulation
