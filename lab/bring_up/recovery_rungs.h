#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lab/bring_up/ladder.h"
#include "lab/bring_up/recovery.h"
#include "lab/bring_up/recovery_check.h"
#include "lab/bring_up/recovery_motion.h"
#include "lab/bring_up/rungs.h"
#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"

namespace koboshi::lab {

// The rungs of falling and of getting up. Each adds the motions that it needs to the files of the robot that
// is tried, unless the user has written some: those of the reference robot, retargeted, and mended until the
// check of motions finds no error, or as few as it gets. What remains is a part of the rung's figure or
// cause.
class RecoveryRungs {
 public:
  // `options`, `robot` and `progress` must outlive this object. A search ends at `end`, unless the options
  // give a number of candidates.
  RecoveryRungs(const BringUpOptions& options, const sim_board::RobotDescription& robot,
                std::chrono::steady_clock::time_point end,
                const std::function<void(const std::string&)>& progress);

  // Throws InputError, Stopped.
  [[nodiscard]] Rung protect_falls(TriedRobot& tried, const simulation::NamedModel& model,
                                   const PlayOptions& play);

  struct Risen {
    Rung rung;
    std::size_t candidates = 0;  // of the search; its log is a file of the robot
  };
  // Plays `rise_prone` or `rise_supine` and, while there is time, searches for a better one. Throws
  // InputError, Stopped.
  [[nodiscard]] Risen rise(const char* name, Lying lying, TriedRobot& tried,
                           const simulation::NamedModel& model, const PlayOptions& play);

 private:
  struct Trial {
    TriedRobot& tried;
    const simulation::NamedModel& model;
    const PlayOptions& play;
  };

  void add_motions(const Trial& trial, const std::vector<std::string>& names);
  std::vector<RecoveryMotion> rise_starts(const Trial& trial, const char* name, Lying lying) const;
  Rung with_found(const Trial& trial, const RecoveryMotion& motion, std::size_t candidates, Lying lying,
                  const Rung& before);
  Rung with_notes(Rung rung) const;
  void note_errors(const RecoveryMotion& motion, RecoveryCheck& check);

  const BringUpOptions& options_;
  const sim_board::RobotDescription& robot_;
  const std::chrono::steady_clock::time_point end_;
  const std::function<void(const std::string&)>& progress_;
  std::map<std::string, RecoveryMotion> motions_;  // by name, before a search
  std::string notes_;                              // about those of the present rung, each after "; "
  std::map<std::string, std::string> errors_;      // that the check finds in them, by motion, as `notes_`
};

}  // namespace koboshi::lab
