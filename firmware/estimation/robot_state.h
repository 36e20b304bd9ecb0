#pragma once

#include <cstdint>
#include <limits>

#include "firmware/estimation/centre_of_mass.h"
#include "firmware/estimation/contact.h"
#include "firmware/estimation/ground.h"
#include "firmware/estimation/odometry.h"
#include "firmware/estimation/zmp.h"
#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// The estimated state of the robot at the end of a control cycle, the only thing that later stages know of
// the body. Frames (docs/design/frames.md): B is the trunk's; a sole's has its origin below the ankle, on the
// ground.
struct RobotState {
  static constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();

  // From gyro and accelerometer.
  robot::Direction up_B = robot::kAxisZ;               // unit vector against gravity
  fixed::Angle roll;                                   // about x, right positive; [-1/2, 1/2) turn
  fixed::Angle pitch;                                  // about y, forward positive; [-1/4, 1/4] turn
  robot::Vector<fixed::AngularRate> rates_B;           // free of the gyro's bias
  fixed::Angle turn;                                   // change of the trunk's heading in this cycle
  robot::Vector<fixed::Acceleration> accelerations_B;  // specific force: one g upwards at rest
  bool gyro_known = false;  // the gyro's bias was measured or stored; without it attitude and rates drift
  std::uint32_t inertial_age_us = kNever;  // since the last sample; saturates

  // From the ankle sensors; without any, the contact is that of the legs' torques (TorqueContact). A robot
  // that does not measure loads has no valid ZMP, and the loads are the weight in equal parts.
  hal::BySide<FootPressure> feet{};
  Pressure zmp;  // of both feet, in the frame of the sole that carries more
  bool measures_loads = true;
  hal::BySide<std::uint32_t> ankle_age_us{kNever, kNever};  // 0 without sensors

  // From the joint angles: the centre of mass, in the frame of `zmp`.
  robot::Position centre_of_mass;
  // From joint angles, attitude and accelerometer.
  CentreOfMassMotion com;

  hal::BySide<ContactState> contacts{};
  Odometer odometer;
  Ground ground;  // of the last time the robot stood still
};

}  // namespace koboshi::estimation
