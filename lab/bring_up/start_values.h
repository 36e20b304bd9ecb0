#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/scenario.h"

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

// Parameters and the standing pose for a robot that nobody has tuned: those of a robot that walks, scaled by
// dynamic similarity (R. McN. Alexander, "Estimates of speeds of dinosaurs", 1976: equal Froude numbers) and
// fitted to the reach of the legs.
//   lengths        by the leg's length, the step's width by the distance of the feet, and less where the legs
//                  do not reach a pose on one foot
//   CoM height     that of straight legs less what the reference's bend lowers it, by the distance from hip
//                  to ankle: knees bend alike, however long or heavy the trunk is
//   times, speeds  by the square root of the leg's length
//   ZMP            at the same place of the sole, by the leg's length
//   sag            by the weight over the stiffness of the servos, pitch and roll joints each by their own,
//                  less where little of that stiffness is left beside gravity
struct StartValues {
  simulation::RobotParameters parameters;
  double com_height_m = 0.0;
  double step_width_m = 0.0;
  double com_forward_m = 0.0;  // of the standing pose, in front of the ankles
  double time_scale = 1.0;     // of the reference's times
  double leg_m = 0.0;          // BodyMeasures::leg_m
  double sole_width_m = 0.0;   // BodyMeasures::sole_width_m
  double com_lowered_m = 0.0;  // CoM height of straight legs less `com_height_m`
  double leg_use = 1.0;        // distance from hip to ankle, as a share of that of straight legs
  std::map<std::string, std::string> unreached{};  // StandingPose::unreached

  // Returns the value of a parameter; 0 if it is not set.
  [[nodiscard]] double value(const std::string& key) const;
};

// Multiplies values of the reference before they are fitted; a search tries others than 1.
struct StartFactors {
  double com_height = 1.0;
  double step_time = 1.0;
  double gains = 1.0;            // of the feedback while walking
  double trunk_pitch_deg = 0.0;  // added
};

// Throws InputError, with the limit, if no gait fits the legs.
[[nodiscard]] StartValues scaled_values(const simulation::RobotParameters& reference,
                                        const BodyMeasures& from, const sim_board::RobotDescription& robot,
                                        const simulation::NamedModel& model,
                                        const StartFactors& factors = {});

// The texts of parameters.yaml and of the motions `stand`, `squat` and `shift`, which compile for this robot.
// `shift` moves the centre of mass over the left foot, then over the right one, as far as the hips permit,
// lets the other foot hang just above the ground, and holds each for a second. `origin` is named in their
// first lines. Throws InputError if the legs do not reach the standing pose.
[[nodiscard]] std::string parameters_text(const StartValues& values, const std::string& origin);
struct StandingPose {
  std::string stand_text;
  std::string squat_text;
  std::string shift_text;
  std::string joints_text;                                 // the pose's angles as a map of YAML, in degrees
  std::vector<std::pair<std::string, double>> joints_deg;  // the same
  double step_s = 0.0;                                     // time of each move
  // Of `squat` and `shift` those that the legs do not reach at any height, and why; their texts are empty.
  std::map<std::string, std::string> unreached{};
};
[[nodiscard]] StandingPose standing_pose(const StartValues& values, const simulation::NamedModel& model,
                                         const std::string& origin);

}  // namespace koboshi::lab
