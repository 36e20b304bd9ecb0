#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lab/bring_up/journal.h"
#include "lab/bring_up/play.h"
#include "lab/bring_up/robot_files.h"
#include "lab/bring_up/start_values.h"

namespace koboshi::lab {

// How robots are played.
struct PlayOptions {
  std::string stepper = "lumped";
  std::string world = "mild";  // in which they are played
  std::uint64_t first_seed = 1;
  std::size_t seeds = 5;
  std::size_t jobs = 1;
  GoOn go_on = [] { return true; };
};

// A robot with the values and files that are tried for it. Its simulations are made when they are first
// needed and kept.
class TriedRobot {
 public:
  // `files` has go.yaml, parameters.yaml and the motions. The references must outlive the object.
  TriedRobot(RobotFiles files, StartValues values, double move_s, const std::filesystem::path& robot,
             const TemporaryFolder& scratch);

  // The same robot with other files.
  TriedRobot with(RobotFiles files) const { return {std::move(files), values_, move_s_, robot_, scratch_}; }

  // Robots that stand, or hang on a stand, ready for a command. Throws InputError, Stopped.
  ReadyRobots& standing(const PlayOptions& options) const { return ready(options, false); }
  ReadyRobots& hanging(const PlayOptions& options) const { return ready(options, true); }
  // The scenario with these overrides, prepared. Throws InputError.
  std::shared_ptr<const simulation::PreparedScenario> prepare(const PlayOptions& options,
                                                              std::vector<Override> overrides) const;

  const RobotFiles& files() const { return files_; }
  RobotFiles& files() { return files_; }
  const StartValues& values() const { return values_; }
  // Time of each move of the motions `squat` and `shift`.
  double move_s() const { return move_s_; }
  // Time for which a walk is played: that of a robot of the default robot's size, scaled.
  double walk_s() const;

 private:
  ReadyRobots& ready(const PlayOptions& options, bool hangs) const;

  struct Kept {
    std::string stepper;
    std::uint64_t first_seed;
    std::size_t seeds;
    bool hangs;
    std::unique_ptr<ReadyRobots> robots;
  };
  RobotFiles files_;
  StartValues values_;
  double move_s_;
  const std::filesystem::path& robot_;
  const TemporaryFolder& scratch_;
  mutable std::vector<Kept> kept_;
};

// A kind of walk. Speeds are in m/s, or in rad/s of a turn.
struct Walk {
  const char* limit;  // the parameter, in a thousandth of that unit
  const char* unit;
  std::function<std::string(double speed)> command;
  std::function<double(const Played&)> made_good;

  // The highest speed that the robot's parameters permit.
  double highest(const StartValues& values) const { return 1e-3 * values.value(limit); }
};
[[nodiscard]] Walk forward_walk();
[[nodiscard]] Walk sideways_walk();
[[nodiscard]] Walk turning_walk();

// Each of these plays a rung with robots of the seeds in the options. Throws InputError, Stopped.

// The drives hold the standing pose in the air, and no links touch.
[[nodiscard]] Rung hang(const TriedRobot& robot, const PlayOptions& options);
// 10 s within 7 degrees of upright. The figure has the largest sag of a servo.
[[nodiscard]] Rung stand(const TriedRobot& robot, const PlayOptions& options);
// Three squats with the torque margins of docs/tutorial/bring-your-robot.md.
[[nodiscard]] Rung squat(const TriedRobot& robot, const PlayOptions& options);
// The centre of mass moves over each foot in turn and stays for 1 s; CoM and ZMP lie within that sole.
[[nodiscard]] Rung shift_weight(const TriedRobot& robot, const PlayOptions& options);
// Steps on the spot.
[[nodiscard]] Rung march(const TriedRobot& robot, const PlayOptions& options);

struct WalkRung {
  Rung rung;
  std::optional<double> speed;  // highest at which all robots walk; nothing if they do at none
  double made_good = 0.0;       // mean of the robots at that speed
};
// Climbs levels of an eighth of the limit, from a quarter of it on, while no robot is lost and all make good
// half of the speed in the mean.
[[nodiscard]] WalkRung fastest(const TriedRobot& robot, const PlayOptions& options, const Walk& walk);
// Returns whether the robots walk so at this speed.
[[nodiscard]] bool walks_at(const TriedRobot& robot, const PlayOptions& options, const Walk& walk,
                            double speed);

// Torque limits of a servo, as shares of its stall torque at nominal supply.
struct TorqueLimits {
  double peak = 1.0;                   // the stall torque that is left at the supply `low_supply_V`
  std::optional<double> continuous{};  // at which its winding stays below the derating temperature
};
[[nodiscard]] TorqueLimits torque_limits(const sim_board::ServoDescription& servo, double low_supply_V);

}  // namespace koboshi::lab
