#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/robot/leg.h"
#include "firmware/robot/model.h"
#include "firmware/walk/plane.h"

namespace koboshi::walk {

// A small rotation: to the right about x and forward about y.
struct Tilt {
  fixed::Angle roll;
  fixed::Angle pitch;
};

// Planned pose of the body in the frame of the support foot's sole, and the load of the feet.
struct Stance {
  robot::Position centre_of_mass;
  fixed::Angle yaw;  // of the trunk, which leans forward by `pitch`
  fixed::Angle pitch;
  hal::BySide<Foothold> soles;
  hal::BySide<fixed::Length> heights{};  // of the soles
  hal::BySide<Tilt> tilts{};             // of the soles, by the ankles alone, beyond level
  hal::BySide<fixed::Ratio> load_shares{};
  Point zmp;
};

// Sag of the joints under the robot's weight at a lever of one metre.
struct Compliance {
  fixed::Angle pitch;
  fixed::Angle roll;
};

// Computes the joint angles of the legs that bring CoM, trunk and soles into a stance.
//
// The masses of a leg lie on the line from hip to ankle. Then the CoM is linear in the positions of trunk B
// and soles L, R,
//
//   p_Com = (1 - 2 mu) p_B + R_SupportB k + mu (p_L + p_R),
//
// and the position of the trunk follows without iteration. mu is the share of a leg's mass that moves with
// the sole. k depends on the angles of waist, arms and head: for a joint i with the share m_i of the robot's
// mass in its link, the share n_i in all links that it carries, and the links j that are mounted on its own,
//
//   M_i = m_i c_i + sum_j (n_j a_j + R_j M_j),   k = k_0 + sum_i (R_i M_i - M_i at joint zero)
//
// with the centre of mass c_i, the anchors a_j, the rotations R_j about the joints, and the second sum over
// the joints on the trunk. Knees in front of that line move the CoM by 1 to 2 mm, in every step
// alike; the parameter zmp_forward takes that up.
//
// Where one motor turns both hip yaws, its angle is the one with which both feet lack the same turn to their
// headings: the feet then have the planned heading relative to each other, and the trunk is turned by what
// they lack. That is little, because a walk plans the trunk's heading as the mean of the feet's.
class Body {
 public:
  // `model` must outlive the body.
  [[gnu::cold]] explicit Body(const robot::RobotModel& model);

  // Returns whether the robot has two legs that walk; `solve` requires them.
  [[nodiscard]] bool has_legs() const { return has_legs_; }
  // Places waist, arms and head for the following poses. `angles` has one angle for each joint of the model;
  // empty: all at zero, as at first.
  void set_upper_body(std::span<const fixed::Angle> angles);

  // Writes the targets of the legs' joints. A leg that does not reach its sole's pose comes as near as it can
  // (robot::leg_inverse_kinematics).
  void solve(const Stance& stance, const Compliance& compliance, std::span<fixed::Angle> targets);
  // Forgets the solution of the last cycle, from which the next one of a leg without closed form begins. No
  // cycle has the time for a whole first solution: the next calls of solve(), all with one stance, share it,
  // and the targets are valid once it is complete. Legs with a closed form are complete after the first call.
  void begin_in_parts();
  [[nodiscard]] bool is_complete() const { return parts_left_ == 0; }
  // Limit of the turn of a step: what one motor for both hip yaws can turn the feet against each other.
  // Nothing for other hips.
  [[nodiscard]] std::optional<fixed::Angle> max_turn() const {
    return shared_yaw_ ? std::optional(max_turn_) : std::nullopt;
  }

 private:
  // Returns the angles from which the Newton steps of a leg begin, and keeps the last solution for the next
  // prediction.
  [[nodiscard]] robot::LegAngles predict(std::size_t side);
  void compensate(std::size_t side, const Stance& stance, const Compliance& compliance,
                  const robot::Position& p_SH, robot::LegAngles& leg) const;

  // Finds the yaw of the next cycle by the headings that the feet lack in this one.
  void follow_headings();
  [[gnu::cold]] void find_upper_body();
  [[nodiscard]] robot::Position upper_body_moment(std::span<const fixed::Angle> angles) const;

  const robot::RobotModel& model_;
  bool has_legs_ = false;
  hal::BySide<robot::LegGeometry> legs_{};
  hal::BySide<robot::LegAngles> solutions_{};  // of the last cycle, without compensation
  hal::BySide<robot::LegAngles> before_{};     // of the cycle before that
  hal::BySide<robot::LegAngles> changes_{};    // from the one before that to before_
  bool is_solved_ = false;
  std::optional<robot::JointIndex> shared_yaw_;               // joint of one motor for both hip yaws
  bool turns_feet_ = false;                                   // that turns the feet against each other
  fixed::Angle max_turn_;                                     // of the feet, by it
  fixed::Gain per_turn_;                                      // its turn per turn of the feet
  fixed::Angle yaw_;                                          // its angle in the next cycle
  fixed::Angle yaw_before_;                                   // the one that the last cycle found
  fixed::Angle yaw_change_;                                   // from the one before that
  int parts_left_ = 0;                                        // of the first solution
  std::uint32_t upper_joints_ = 0;                            // of waist, arms and head; bit i: joint i
  std::array<robot::Position, robot::kMaxJoints> moments_{};  // m_i c_i + sum_j n_j a_j
  robot::Position hanging_moment_;                            // of the upper body at joint zero
  robot::Position hanging_B_;                                 // k_0
  robot::Position constant_B_;                                // k
  fixed::Ratio foot_share_;                                   // mu
  fixed::Ratio inverse_share_;                                // 1 / (1 - 2 mu)
};

}  // namespace koboshi::walk
