#pragma once

#include <array>
#include <span>

#include "firmware/robot/leg.h"
#include "firmware/robot/model.h"
#include "firmware/walk/plane.h"

namespace koboshi::walk {

// Where the body is to be, in the frame of the sole that stands.
struct Stance {
  robot::Position centre_of_mass;
  fixed::Angle yaw;  // of the trunk, which leans ahead by `pitch`
  fixed::Angle pitch;
  std::array<Foothold, 2> soles;           // by Side
  std::array<fixed::Length, 2> heights{};  // of the soles
  std::array<fixed::Ratio, 2> load_shares{};
  Point zmp;
};

// How far joints turn under the robot's weight at a lever of one metre.
struct Compliance {
  fixed::Angle pitch;
  fixed::Angle roll;
};

// The joint angles of the legs that put centre of mass, trunk and soles where they are to be.
//
// The centre of mass is that of the arms hanging down, and of legs that carry their masses along the line
// from hip to ankle: then it is linear in the positions of trunk and soles,
//   p_Com = (1 - 2 mu) p_B + R_SB k + mu (p_L + p_R),
// and the trunk's place follows without iteration. Knees ahead of that line move it by a millimetre or two: a
// constant that the parameters take up.
class Body {
 public:
  // The model must outlive this, and have legs.
  explicit Body(const robot::RobotModel& model);

  // Writes the targets of the legs' joints. Where a leg does not reach it comes as near as it can.
  void solve(const Stance& stance, const Compliance& compliance, std::span<fixed::Angle> targets) const;

 private:
  void compensate(std::size_t side, const Stance& stance, const Compliance& compliance,
                  const robot::Position& p_SH, robot::LegAngles& leg) const;

  const robot::RobotModel& model_;
  std::array<robot::LegGeometry, 2> legs_{};
  robot::Position constant_B_;  // k
  fixed::Ratio foot_share_;     // mu
  fixed::Ratio inverse_share_;  // 1 / (1 - 2 mu)
};

}  // namespace koboshi::walk
