#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/model/robot_model.h"

namespace koboshi::simulation {

// The names of a robot's joints in motion files, and its left-right table.
class JointNames {
 public:
  explicit JointNames(const NamedModel& robot);

  // Returns the joint with this full name, otherwise the one with this role.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;
  // Returns the left joint of a name without its side, as `knee`.
  [[nodiscard]] std::optional<std::size_t> find_left(std::string_view sideless) const;
  // Returns the mask of a joint, a name without its side, or a group: head, arms, legs, left_arm, ...; 0 for
  // an unknown name.
  [[nodiscard]] std::uint32_t mask(std::string_view name) const;
  // All names of joints, with and without their side; with groups if `groups`.
  [[nodiscard]] std::vector<std::string> all(bool groups) const;

  [[nodiscard]] std::size_t count() const { return robot_.joint_names.size(); }
  [[nodiscard]] const std::string& name(std::size_t joint) const { return robot_.joint_names[joint]; }
  [[nodiscard]] std::size_t mirror(std::size_t joint) const { return robot_.model.joints[joint].mirror; }
  [[nodiscard]] int mirror_sign(std::size_t joint) const { return robot_.model.joints[joint].mirror_sign; }
  [[nodiscard]] const NamedModel& robot() const { return robot_; }

 private:
  const NamedModel& robot_;
};

}  // namespace koboshi::simulation
