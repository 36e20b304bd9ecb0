#pragma once

#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "firmware/motion/motion.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {

// Writes valid and invalid motion images in the format of docs/reference/motion-format.md.
struct MotionBuilder {
  std::string name = "test";
  std::uint32_t model_id = 0;
  std::uint16_t joint_count = 20;
  std::vector<std::pair<std::uint32_t, std::vector<std::int32_t>>> poses;  // mask, angles
  std::vector<motion::Step> steps;

  explicit MotionBuilder(const robot::RobotModel& model) : model_id(model.id) {}

  // Adds a pose that moves one joint to an angle and leaves the others.
  MotionBuilder& pose(std::size_t joint, double angle_deg) {
    std::vector<std::int32_t> angles(joint_count);
    angles[joint] = degrees(angle_deg).raw();
    poses.emplace_back(1u << joint, angles);
    return *this;
  }
  MotionBuilder& step(motion::Opcode opcode, std::uint16_t operand = 0, std::uint32_t time_us = 0) {
    steps.push_back({opcode, operand, time_us});
    return *this;
  }

  std::vector<std::byte> image() const {
    std::vector<std::byte> bytes;
    put(bytes, motion::kMotionMagic, 4);
    put(bytes, motion::kMotionVersion, 4);
    bytes.resize(16);
    put(bytes, model_id, 4);
    for (std::size_t i = 0; i < motion::kNameSize; ++i) {
      put(bytes, i < name.size() ? static_cast<unsigned char>(name[i]) : 0u, 1);
    }
    put(bytes, joint_count, 2);
    put(bytes, static_cast<std::uint32_t>(poses.size()), 2);
    put(bytes, static_cast<std::uint32_t>(steps.size()), 2);
    for (const auto& [mask, angles] : poses) {
      put(bytes, mask, 4);
      for (const std::int32_t angle : angles) put(bytes, static_cast<std::uint32_t>(angle), 4);
    }
    for (const motion::Step& step : steps) {
      put(bytes, static_cast<std::uint32_t>(step.opcode), 2);
      put(bytes, step.operand, 2);
      put(bytes, step.time_us, 4);
    }
    seal(bytes);
    return bytes;
  }
};

// Returns the test robot as the firmware loads it.
inline robot::RobotModel load_test_robot() {
  robot::RobotModel model;
  if (load_model(encode(make_test_robot()), model) != robot::ModelStatus::kOk) std::abort();
  return model;
}

}  // namespace koboshi::test
