#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/dictionary.h"
#include "firmware/motion/instructions.h"
#include "firmware/robot/model.h"
#include "tests/unit/firmware/motion/motion_builder.h"

namespace koboshi::test {

// A motion as stored in its image: each pose gives an angle for each joint.
struct TestMotion {
  std::string name = "test";
  std::vector<std::vector<fixed::Angle>> poses;
  std::vector<motion::Step> steps;
};

// Encodes a motion for the robot with this model id, in the format of
// firmware/motion/motion.h.
std::vector<std::byte> encode(const TestMotion& motion, std::uint32_t model_id);

// Encodes those parameters that differ from the neutral ones for the robot with this model id, in the format
// of firmware/app/factory_parameters.h.
std::vector<std::byte> encode(const app::ControllerValues& values, std::uint32_t model_id);

// Returns the storage contents of a robot: a catalogue (firmware/storage/catalogue.h), the images of the
// model and of the motions, where the i-th becomes motion i, and the image of the parameters unless it is
// empty.
std::vector<std::byte> make_storage(std::span<const std::byte> model,
                                    std::span<const std::vector<std::byte>> motions,
                                    std::span<const std::byte> parameters = {});

}  // namespace koboshi::test
