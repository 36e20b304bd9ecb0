#pragma once

#include "sim_board/description/description.h"

namespace koboshi::lab {

// The dimensions of a robot on which its walk depends, measured at joint angles zero.
struct BodyMeasures {
  double leg_m = 0.0;          // from the sole to the hip's pitch axis
  double limb_m = 0.0;         // from the ankle's pitch axis to the hip's
  double com_m = 0.0;          // height of the centre of mass above the soles
  double stance_m = 0.0;       // between the middles of the soles
  double sole_width_m = 0.0;   // of both soles together, side by side: the least distance of their middles
  double sole_middle_m = 0.0;  // x of the middle of a sole, in front of the ankle
  double weight_N = 0.0;
  double supply_V = 0.0;  // of the battery, else of the servos
  // Torque for an error of the position, until the full voltage: of the weakest pitch joint and the weakest
  // roll joint of the left leg.
  double pitch_stiffness_Nm_per_rad = 0.0;
  double roll_stiffness_Nm_per_rad = 0.0;
};

// Throws InputError, naming what is missing, for a robot whose legs cannot walk.
[[nodiscard]] BodyMeasures measure(const sim_board::RobotDescription& robot);

}  // namespace koboshi::lab
