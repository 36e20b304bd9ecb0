#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/flash/flash_model.h"
#include "hal/port/side.h"
#include "sim_board/board/controller_host.h"
#include "sim_board/board/sim_board.h"
#include "sim_board/state/archive.h"
#include "simulation/disturbance/disturbed_world.h"
#include "simulation/host/flash_memory.h"
#include "simulation/joint_level/joint_master.h"
#include "simulation/model/robot_model.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/scenario/player.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// A scenario for robots without a controller's behaviour, with its files read. Robots may share it in any
// threads.
struct JointScenario {
  Scenario scenario;
  sim_board::RobotDescription robot;           // as in its file: what a controller knows
  sim_board::RobotDescription robot_in_world;  // with the scenario's `plant`
  NamedModel model;
};

// Throws InputError for an error in a file of the scenario, and for a scenario with commands, parameters,
// motions or a gait, which need the firmware's behaviour.
[[nodiscard]] std::shared_ptr<const JointScenario> prepare_joint_level(const Scenario& scenario);

// One kind of measurement in a row of observations.
struct ObservationField {
  std::string name;     // ends with the unit
  std::size_t first{};  // index of its first number
  std::size_t size{};   // how many numbers
  std::string meaning;
};

// The robot, its drives, its sensors and its bus, controlled from outside joint by joint: targets go in,
// measurements come out, with the latencies and the quantisation that the firmware sees. Between two steps
// the measurements are those on which the firmware would decide at this time: the frames that have arrived
// and the samples that have been taken. Targets leave with the next control cycle (every 10 ms), after the
// computing time of the scenario.
class JointRobot {
 public:
  // Powers everything on and boots the drives: `now_us()` is then a multiple of the control period, and the
  // drives hold the angles that they found. Throws what the board throws, and std::runtime_error, naming the
  // joint, if a drive does not boot.
  JointRobot(std::shared_ptr<const JointScenario> prepared, std::uint64_t seed);
  JointRobot(const JointRobot&) = delete;
  JointRobot& operator=(const JointRobot&) = delete;

  // Restarts the scenario with another seed, with the same bits as a new robot, and holds the pose in which
  // the drives were enabled until this simulated time, if it is later. Saved states are then of no use.
  void reset(std::uint64_t seed, std::uint64_t until_us = 0);

  // Targets of all joints in rad; a joint's limits bound them. Throws std::invalid_argument, naming the
  // joint, for one that is not finite, and for another number of targets than of joints.
  void set_targets(std::span<const double> targets_rad);
  // Limits of the drives' torques, as shares (0 to 1) of their rated torques. Travels by SDO, and takes some
  // control cycles. Errors as of set_targets.
  void limit_torques(std::span<const double> shares);
  // Switches the torque of all drives off or, initially and again, on.
  void enable(bool enabled) { power_->master.enable(enabled); }

  // Advances by this many milliseconds. Throws what the board throws.
  void step(std::size_t milliseconds);

  // Writes a row of observations, in the order of fields().
  void observe(std::span<double> to) const;
  [[nodiscard]] const std::vector<ObservationField>& fields() const { return fields_; }
  [[nodiscard]] std::size_t observation_size() const;
  // The samples of the inertial unit during the last step, at most its last 1,024: rows of gyro (rad/s) and
  // accelerometer (m/s^2) in its own frame.
  [[nodiscard]] std::vector<std::array<double, 6>> imu_samples() const;
  // The first fault of a drive in a sentence, or empty.
  [[nodiscard]] std::string fault() const;
  // When the scenario's stand releases the robot; 0: it has none.
  [[nodiscard]] std::uint64_t release_us() const { return scenario_.initial.release_us.value_or(0); }
  // Angle of the trunk's z axis from the vertical, ground truth.
  [[nodiscard]] double tilt_rad() const;
  [[nodiscard]] bool enabled() const { return power_->master.enabled() && !power_->master.fault(); }
  // Computes the ground truth of the present instant, without quantities that depend on the history.
  [[nodiscard]] GroundTruth truth() const;

  // As ScenarioPlayer::push; it has been checked.
  void push(const Push& push) { power_->player->push(push); }
  // Saves the state between two steps; `restore` returns to it any number of times, with the same bits.
  // Throws std::logic_error, which says which, for a state of another robot or from before a reset().
  struct Identity {};  // a robot, by its address
  struct Run {         // a robot between two resets, by its address
    std::shared_ptr<const Identity> robot;
  };
  struct Saved {
    std::shared_ptr<const Run> run;
    sim_board::SavedState state;
  };
  [[nodiscard]] Saved save();
  void restore(const Saved& saved);

  [[nodiscard]] std::uint64_t now_us() const { return board().now_us(); }
  [[nodiscard]] std::uint64_t seed() const { return scenario_.seed; }
  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  // The robot in the world, with what the seed has drawn.
  [[nodiscard]] const sim_board::RobotDescription& robot() const { return power_->robot; }
  [[nodiscard]] const DisturbedWorld* world() const { return power_->world ? &*power_->world : nullptr; }
  [[nodiscard]] const NamedModel& model() const { return prepared_->model; }
  [[nodiscard]] const sim_board::SimBoard& board() const { return *power_->board; }
  [[nodiscard]] sim_board::SimBoard& board() { return *power_->board; }

 private:
  // The parts that live from one power-on to the next.
  struct Power final : sim_board::ControllerHost {
    Power(const JointScenario& prepared, const Scenario& scenario);
    void exchange(const hal::BatchInput&, hal::BatchOutput& output) override { output = master.respond(); }
    void archive(sim_board::StateArchive& archive) override {
      archive(storage);
      archive.in_place(master);
    }

    FlashMemory flash{{}};
    hal::FlashModel storage{flash.bytes()};
    JointMaster master;
    sim_board::RobotDescription robot;
    std::optional<DisturbedWorld> world;
    std::unique_ptr<sim_board::SimBoard> board;
    std::unique_ptr<ScenarioPlayer> player;
  };

  void power_on();
  void advance();

  const std::shared_ptr<const JointScenario> prepared_;
  Scenario scenario_;  // the prepared one with this robot's seed
  std::vector<ObservationField> fields_;
  std::unique_ptr<Power> power_;
  std::shared_ptr<const Run> run_ = std::make_shared<Run>(Run{std::make_shared<Identity>()});
};

}  // namespace koboshi::simulation
