#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "firmware/motion/instructions.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {

// The angle nearest to this one that a pose can have, which an image stores in units of 2^-14 turn.
inline fixed::Angle stored(double angle_deg) {
  return fixed::Angle::from_raw(motion::pose_number(degrees(angle_deg)) * (1 << motion::kPoseShift));
}
inline double stored_deg(double angle_deg) { return fixed::to_double(stored(angle_deg)) / kRadPerDegree; }

// Writes valid and invalid motion images in the format of docs/reference/motion-language.md.
struct MotionBuilder {
  struct Group {
    std::uint32_t joints = 0;
    std::vector<std::vector<std::int32_t>> poses;  // numbers of 2^-14 turn, by joint of the group
  };

  std::uint16_t version = motion::kMotionVersion;
  std::string name = "test";
  std::uint32_t model_id = 0;
  std::uint8_t joint_count = 20;
  std::uint8_t variable_count = 0;
  std::uint16_t exit_step = motion::kNoStep;
  std::vector<Group> groups;
  std::vector<motion::Step> steps;

  explicit MotionBuilder(const robot::RobotModel& model) : MotionBuilder(model.id) {}
  explicit MotionBuilder(std::uint32_t model) : model_id(model) {}

  // Adds a pose that moves one joint to an angle and leaves the others. Poses are numbered as they are added
  // if those of one joint follow each other.
  MotionBuilder& pose(std::size_t joint, double angle_deg) {
    return packed_pose(1u << joint, {motion::pose_number(degrees(angle_deg))});
  }
  MotionBuilder& packed_pose(std::uint32_t joints, std::vector<std::int32_t> numbers) {
    const auto same = [joints](const Group& group) { return group.joints == joints; };
    auto group = std::find_if(groups.begin(), groups.end(), same);
    if (group == groups.end()) group = groups.insert(group, Group{joints, {}});
    group->poses.push_back(std::move(numbers));
    return *this;
  }
  MotionBuilder& step(motion::Opcode opcode, std::uint16_t operand = 0, std::uint32_t value = 0,
                      std::uint8_t mode = 0) {
    steps.push_back({opcode, operand, value, mode});
    return *this;
  }
  MotionBuilder& step(const motion::Step& step) {
    steps.push_back(step);
    return *this;
  }

  std::vector<std::byte> image() const {
    std::vector<std::byte> bytes;
    put(bytes, motion::kMotionMagic, 4);
    put(bytes, version, 4);
    bytes.resize(16);
    put(bytes, model_id, 4);
    for (std::size_t i = 0; i < motion::kNameSize; ++i) {
      put(bytes, i < name.size() ? static_cast<unsigned char>(name[i]) : 0u, 1);
    }
    std::size_t poses = 0;
    for (const Group& group : groups) poses += group.poses.size();
    put(bytes, joint_count, 1);
    put(bytes, variable_count, 1);
    put(bytes, static_cast<std::uint32_t>(groups.size()), 2);
    put(bytes, static_cast<std::uint32_t>(poses), 2);
    put(bytes, static_cast<std::uint32_t>(steps.size()), 2);
    put(bytes, exit_step, 4);
    for (const Group& group : groups) {
      put(bytes, group.joints, 4);
      put(bytes, static_cast<std::uint32_t>(group.poses.size()), 4);
    }
    for (const Group& group : groups) {
      for (const std::vector<std::int32_t>& pose : group.poses) put_packed(bytes, pose);
    }
    for (const motion::Step& step : steps) {
      put(bytes, static_cast<std::uint32_t>(step.opcode), 1);
      put(bytes, step.mode, 1);
      put(bytes, step.operand, 2);
      put(bytes, step.value, 4);
    }
    seal(bytes);
    return bytes;
  }

 private:
  static void put_packed(std::vector<std::byte>& bytes, const std::vector<std::int32_t>& numbers) {
    std::vector<bool> bits;
    for (const std::int32_t number : numbers) {
      for (int bit = 0; bit < motion::kPoseBits; ++bit) bits.push_back((number >> bit & 1) != 0);
    }
    bits.resize((bits.size() + 7) / 8 * 8);
    for (std::size_t i = 0; i < bits.size(); i += 8) {
      std::uint32_t byte = 0;
      for (std::size_t bit = 0; bit < 8; ++bit) byte |= (bits[i + bit] ? 1u : 0u) << bit;
      put(bytes, byte, 1);
    }
  }
};

// Returns the test robot as the firmware loads it.
inline robot::RobotModel load_test_robot() {
  robot::RobotModel model;
  if (load_model(encode(make_test_robot()), model) != robot::ModelStatus::kOk) std::abort();
  return model;
}

}  // namespace koboshi::test
