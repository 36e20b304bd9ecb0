#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "simulation/model/robot_model.h"

namespace koboshi::simulation {

// Cartesian targets of a pose: coordinates in the frame of the support foot's sole (x forward, y left, z up).
// A coordinate without a target keeps its value.
struct Target {
  std::array<std::optional<double>, 3> position_m;
  std::array<std::optional<double>, 3> rpy_rad;  // roll, pitch, yaw about the fixed axes x, y, z

  bool is_given() const;
};

// The target that gives all coordinates: a point in m, and roll, pitch and yaw in rad.
[[nodiscard]] Target target_of(const Eigen::Vector3d& position_m, const Eigen::Vector3d& rpy_rad);
[[nodiscard]] Target target_of(const Eigen::Isometry3d& X);

struct BodyTargets {
  enum class Support { kLeft, kRight, kBoth };

  // kBoth: the frame lies midway between the soles.
  Support support = Support::kBoth;
  Target trunk;                   // its point is the centre between the hips
  Target com;                     // of the whole robot; position only
  std::array<Target, 2> feet{};   // soles; left, right
  std::array<Target, 2> hands{};  // tips; position only

  bool moves_legs() const;
};

// The angles that reach the targets, or the first target that cannot be reached.
struct BodySolution {
  std::vector<fixed::Angle> angles;  // of all joints, within their limits
  std::uint32_t joints = 0;          // those that the targets determine: both legs, or an arm
  std::string unreached;             // "left_hand"; empty: all are reached
  double missing_m = 0.0;            // between the nearest point and the target
  double missing_rad = 0.0;          // between the orientations, where the point is reached
};

// Computes the joint angles for targets. `angles` is the pose from which the robot starts. The legs have a
// closed form (firmware/robot/leg.h); the trunk's position for a centre of mass, and arms, are solved
// iteratively: by at most 60 corrections, and 100 steps of damped least squares from each of four poses of
// the arm. Deterministic.
[[nodiscard]] BodySolution solve_targets(const NamedModel& robot, const BodyTargets& targets,
                                         std::span<const fixed::Angle> angles);

}  // namespace koboshi::simulation
