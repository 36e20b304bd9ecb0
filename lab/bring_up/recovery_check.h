#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "lab/bring_up/recovery_motion.h"
#include "tools/motion_check/check.h"

namespace koboshi::lab {

// Checks the motions by which a robot falls, rolls over and rises as `koboshi motion check` does, and mends
// what a slower or less folded motion mends.
class RecoveryCheck {
 public:
  // Reads the robot's file, and parameters.yaml and motions/stand.yaml beside it. Throws InputError.
  explicit RecoveryCheck(const std::filesystem::path& robot) : checker_(robot) {}

  // Returns the errors of a motion, each in words. Throws InputError for one that does not compile.
  [[nodiscard]] std::vector<std::string> errors(const RecoveryMotion& motion);
  // Returns the motion with slower steps where joints turn too fast or lack torque, with legs that are less
  // parted where folded feet touch, and with hips that bend less where a thigh meets the trunk, until the
  // check finds no more or nothing of this kind helps. Throws as errors().
  [[nodiscard]] RecoveryMotion mended(const RecoveryMotion& motion);

 private:
  std::vector<tools::Finding> findings(const RecoveryMotion& motion);
  // The motion changed for one finding.
  RecoveryMotion changed(const RecoveryMotion& motion, const tools::Finding& finding) const;
  // Whether a link is one of a leg, and its side; -1: neither.
  int side_of_leg(std::size_t link) const;

  tools::MotionChecker checker_;
  std::vector<tools::StepPlace> places_;  // of the motion that was checked last
};

}  // namespace koboshi::lab
