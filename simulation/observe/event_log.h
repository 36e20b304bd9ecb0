#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/dictionary.h"
#include "firmware/behaviour/command.h"
#include "firmware/behaviour/state.h"
#include "firmware/walk/velocity.h"
#include "hal/port/can.h"
#include "sim_board/can/sdo_block_tracker.h"
#include "simulation/disturbance/disturbed_world.h"
#include "simulation/model/robot_model.h"
#include "simulation/observe/event_store.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/telemetry.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Log of the events of a run with time and cause, as sentences and as data (docs/reference/events.md).
// Observes only the frames on the bus and the ground truth, not the firmware's internals.
class EventLog {  // Large: one member per kind of event seen last
 public:
  // Scenario and model must outlive the log. `limits` are the velocity limits of the controller.
  EventLog(const Scenario& scenario, const NamedModel& model, const walk::VelocityLimits& limits = {});

  // Processes a frame at the end of its last bit, after `said` has been updated from it.
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t end_us, const Telemetry& said);
  // Processes a tick. `pushes` must contain all pushes that have begun, in order of time; it may contain
  // later ones.
  void observe_tick(std::uint64_t now_us, const Telemetry& said, const GroundTruth& truth,
                    std::span<const Push> pushes);
  // Adds, at the beginning, what a world has drawn for the robot.
  void add_world(const DisturbedWorld& world, const sim_board::RobotDescription& robot);
  // Adds an event that only the caller can detect.
  void add(std::uint64_t time_us, const std::string& kind, const std::string& text,
           nlohmann::ordered_json fields = nlohmann::ordered_json::object());
  // Adds a clause to the verdict.
  void remark(const std::string& clause) { remarks_.push_back(clause); }

  // Returns the events in order of time. The last one is the end of the run, with the verdict as its text.
  std::vector<RunEvent> events(bool controller_is_dead = false) const;
  // Returns the events so far, in order of detection. A group of emergency messages still changes the text of
  // its event; the end adds others (`events`).
  std::span<const RunEvent> so_far() const { return events_.stored(); }
  // Returns the verdict, for example "stands; fell once at 3.2 s and got up in 3.4 s; 0 faults".
  std::string verdict(bool controller_is_dead = false) const;
  // Number of times the trunk's lean has exceeded 60 degrees. A robot that starts beyond this lean has not
  // fallen.
  std::size_t falls() const { return falls_.size(); }
  // Returns whether the robot is on its feet, according to the trunk's lean and the controller's state.
  bool stands() const;
  // Returns the robot's posture at the last tick as in the verdict: "stands", "lies, fault: IMU silent".
  std::string posture(bool controller_is_dead = false) const;
  // The last command with its outcome: "walk: refused, not in this state (limp)". Empty before the first
  // command.
  const std::string& last_command() const { return last_command_; }
  // Text of the latest event other than a command; empty before the first.
  const std::string& last_text() const { return last_text_; }

  void archive(sim_board::StateArchive& archive);

 private:
  struct Fall {
    std::uint64_t at_us;
    std::optional<std::uint64_t> up_us;
  };
  struct GivenCommand {
    std::uint64_t time_us;
    behaviour::Command command;
    std::int16_t argument;
    std::optional<walk::Velocity> velocity;
    behaviour::State state;  // as reported at that time
  };
  struct EmergencyGroup {
    std::optional<std::size_t> event;  // nothing: left out
    std::uint64_t last_us;
  };

  void hear_command(behaviour::Command command, std::int16_t argument, std::uint64_t time_us,
                    const Telemetry& said);
  void hear_sdo(const hal::CanFrame& frame, std::uint64_t time_us, const Telemetry& said);
  void hear_emergency(const hal::CanFrame& frame, std::uint64_t time_us);
  void judge_commands(std::uint64_t time_us, const Telemetry& said);
  void judge_velocity(std::uint64_t time_us, const Telemetry& said);
  // Records a command's outcome. No value: unknown; Reason::kNone: accepted.
  void judge(const GivenCommand& given, std::optional<behaviour::Reason> refusal);
  void follow_state(std::uint64_t time_us, const Telemetry& said);
  void tell_cut_off(std::uint64_t time_us, const Telemetry& said);
  void tell_state(std::uint64_t time_us, const Telemetry& said);
  void follow_truth(std::uint64_t now_us);
  void follow_scenario(std::uint64_t now_us, std::span<const Push> pushes);
  void tell_push(const Push& push);

  std::string motion_name(int number) const;
  std::string node_name(std::uint8_t node) const;
  std::string reason_text(const Telemetry& said) const;
  std::string falls_text() const;

  const Scenario& scenario_;
  const NamedModel& model_;
  const walk::VelocityLimits limits_;
  EventStore events_;

  Telemetry said_{};  // at the last tick; state and motion as before the present frame
  GroundTruth truth_{};
  std::uint64_t now_us_ = 0;
  bool heard_state_ = false;
  std::uint64_t entered_us_ = 0;  // time at which the present state was entered

  std::vector<GivenCommand> given_;  // commands without a known outcome yet
  std::optional<walk::Velocity> velocity_;
  std::optional<std::uint64_t> velocity_us_;  // time of a velocity that no command has followed yet
  std::optional<walk::Velocity> reported_velocity_;
  sim_board::SdoBlockTracker sdo_blocks_;  // of the controller's channel
  std::int16_t sdo_argument_ = 0;
  std::string last_command_;
  std::string last_text_;
  std::size_t refused_ = 0;

  std::map<std::pair<std::uint16_t, bool>, EmergencyGroup> emergencies_;  // by error code and has_node()
  std::vector<Fall> falls_;
  bool is_down_ = false;  // set at a lean of more than 60 degrees, cleared below 30
  bool was_upright_ = false;
  std::optional<std::uint64_t> down_us_;  // start of the present recovery
  const char* down_by_ = "";
  std::size_t attempts_ = 0;
  std::vector<std::string> cut_offs_;  // "bow was cut off at 5.31 s", "bow failed at 5.31 s"
  std::vector<std::string> remarks_;
  std::size_t next_push_ = 0;
  std::vector<bool> begun_;  // faults of the scenario that have begun
  std::vector<bool> ended_;
  bool released_ = false;
};

// Returns the events as text, one line each: "  3.210 s  The trunk is pushed ...".
[[nodiscard]] std::string events_text(std::span<const RunEvent> events);

}  // namespace koboshi::simulation
