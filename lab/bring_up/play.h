#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firmware/behaviour/state.h"
#include "simulation/assembly/prepared_scenario.h"
#include "simulation/assembly/snapshot.h"
#include "simulation/observe/watched_simulation.h"

namespace koboshi::lab {

// Returns false once the user has ended the program (Ctrl-C). Any thread may call it.
using GoOn = std::function<bool()>;

// The user has ended the program: thrown by everything that plays robots once GoOn returns false.
class Stopped {};

// The load and the sag of a joint in a run.
struct JointUse {
  double torque = 0.0;      // largest share of the rated torque, which is the servo's stall torque
  double rms_torque = 0.0;  // root mean square of that share
  double sag_rad = 0.0;     // largest mean of |target - angle| over half a second
};

// The outcome of one robot from the command on, or before it, if it was lost there.
struct Played {
  bool lost = false;  // the trunk leaned by more than 0.6 rad, or the physics ended the run
  behaviour::State state = behaviour::State::kBoot;
  std::string reason;     // of the state
  double at_s = 0.0;      // when it was lost, after the command
  double lean_rad = 0.0;  // largest
  std::vector<JointUse> joints;
  std::array<double, 2> speed_m_per_s{};  // forward and to the left, over the second half
  double turn_rad_per_s = 0.0;            // over the second half
  std::string on_ground;                  // the first link but the feet that touched the ground
  std::string touching;                   // what the event log says of links that touch
};

// Watches a robot after each tick. `at_s` is the time since the command.
using Watcher = std::function<void(const simulation::WatchedSimulation&, double at_s)>;
// Makes the watcher of the robot with this number; called once for each robot.
using MakeWatcher = std::function<Watcher(std::size_t robot)>;

// Robots with the same files and different seeds, each ready for a command: it stands (or hangs), and has
// measured its gyro's bias. Every command starts from a snapshot of that moment.
class ReadyRobots {
 public:
  // The robots have the seeds `first_seed` to `first_seed` + `count` - 1, which also draw their worlds.
  // Throws InputError, and Stopped.
  ReadyRobots(std::shared_ptr<const simulation::PreparedScenario> prepared, std::uint64_t first_seed,
              std::size_t count, std::size_t jobs, GoOn go_on);
  ReadyRobots(const ReadyRobots&) = delete;
  ReadyRobots& operator=(const ReadyRobots&) = delete;
  ~ReadyRobots();

  // Plays a command of the operator (simulation::command), or none, for this time. The results are in the
  // order of the seeds and do not depend on earlier calls or on the number of jobs. Throws Stopped.
  [[nodiscard]] std::vector<Played> play(const std::string& command, double for_s,
                                         const MakeWatcher& make_watcher = {});

  // The robot as its file describes it.
  const sim_board::RobotDescription& robot() const { return prepared_->robot; }

 private:
  struct Ready;

  void make_ready(Ready& ready);
  Played play_one(Ready& ready, const std::string& command, double for_s, const Watcher& watcher) const;

  const std::shared_ptr<const simulation::PreparedScenario> prepared_;
  const std::size_t jobs_;
  const GoOn go_on_;
  std::vector<std::unique_ptr<Ready>> robots_;
};

// Number of robots that are lost, or not in this state.
[[nodiscard]] std::size_t losses(const std::vector<Played>& all, behaviour::State state);
// The first link but the feet that touches the ground in any of these; empty: none.
[[nodiscard]] std::string grounded_link(const std::vector<Played>& all);
// Why the first of these is lost: "3 of 5 robots fall, the first 2.1 s after the command".
[[nodiscard]] std::string cause_of(const std::vector<Played>& all, behaviour::State state);
[[nodiscard]] double largest_lean_rad(const std::vector<Played>& all);

// The joint that uses most of something, over all robots, and how much.
struct LargestUse {
  std::string joint;
  double value = 0.0;
};
[[nodiscard]] LargestUse largest_use(const std::vector<Played>& all, const sim_board::RobotDescription& robot,
                                     double JointUse::*member);

}  // namespace koboshi::lab
