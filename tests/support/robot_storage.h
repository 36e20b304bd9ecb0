#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/dictionary.h"
#include "firmware/motion/motion.h"
#include "firmware/robot/model.h"

namespace koboshi::test {

// A motion as its image holds it: every pose gives an angle for each joint.
struct TestMotion {
  std::string name = "test";
  std::vector<std::vector<fixed::Angle>> poses;
  std::vector<motion::Step> steps;
};

// The image of a motion for the robot with this model id, written after firmware/motion/motion.h.
std::vector<std::byte> encode(const TestMotion& motion, std::uint32_t model_id);

// The image of the parameters that these values have and neutral ones do not, for the robot with this model
// id, written after firmware/app/factory_parameters.h.
std::vector<std::byte> encode(const app::ControllerValues& values, std::uint32_t model_id);

// What the storage of a robot holds: a catalogue (firmware/storage/catalogue.h), the model's image, the
// motions', the i-th as motion i, and, unless it is empty, that of its parameters.
std::vector<std::byte> make_storage(std::span<const std::byte> model,
                                    std::span<const std::vector<std::byte>> motions,
                                    std::span<const std::byte> parameters = {});

}  // namespace koboshi::test
