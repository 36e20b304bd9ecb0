#pragma once

#include <map>
#include <string>

#include "lab/bring_up/body_measures.h"
#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

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
  std::filesystem::path robot_file{};  // named in errors: the values have no file yet
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

// The text of parameters.yaml; `origin` is named in its first line.
[[nodiscard]] std::string parameters_text(const StartValues& values, const std::string& origin);

}  // namespace koboshi::lab
