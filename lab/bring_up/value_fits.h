#pragma once

#include "lab/bring_up/body_measures.h"
#include "lab/bring_up/start_values.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// Sets a CoM height and what follows from it.
void set_com_height(StartValues& values, const BodyMeasures& body, double height_m);

// Changes the values that the robot's body refuses, and straightens the legs where they do not reach their
// steps. Throws InputError for a value that cannot be mended.
void fit_values(simulation::RobotParameters& parameters, const BodyMeasures& body,
                const robot::RobotModel& model);

// Narrows the steps, and then straightens the legs, until they reach the standing pose, its squat and the
// shifts of the weight: hips that are far apart do not reach as far to the side as those of the reference.
// Values of which none is reached stay as they are.
void fit_stance(StartValues& values, const BodyMeasures& body, const simulation::NamedModel& model);

}  // namespace koboshi::lab
