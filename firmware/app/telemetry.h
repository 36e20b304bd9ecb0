#pragma once

#include "firmware/app/dictionary.h"
#include "firmware/behaviour/behaviour.h"
#include "firmware/estimation/estimator.h"

namespace koboshi::app {

// Write the results of the stages of a control cycle into the object dictionary, in its units.
void show(const estimation::RobotState& robot, ControllerValues& values);
void show(const estimation::Estimator& estimator, ControllerValues& values);
void show(const behaviour::Behaviour& behaviour, ControllerValues& values);

}  // namespace koboshi::app
