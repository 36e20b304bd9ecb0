#pragma once

#include <filesystem>
#include <map>
#include <memory>

#include "simulation/scenario/scenario.h"
#include "tools/motion_check/check.h"

namespace koboshi::lab {

// The check of motions in a search: a motion with which a robot only succeeds because its simulated servos
// have no worse day, or because its links pass through each other, is no result.
class CheckedMotions {
 public:
  // Checks the motions of which the scenario changes numbers as `koboshi motion check` does. Throws
  // InputError at the first error, with the motion and the check's code as the limit that it violates, and
  // for files that cannot be read or compiled.
  void check(const simulation::Scenario& scenario);

 private:
  std::map<std::filesystem::path, std::unique_ptr<tools::MotionChecker>> checkers_;  // by the robot's file
};

}  // namespace koboshi::lab
