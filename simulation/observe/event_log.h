#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/dictionary.h"
#include "firmware/behaviour/command.h"
#include "firmware/behaviour/state.h"
#include "firmware/walk/velocity.h"
#include "hal/port/can.h"
#include "sim_board/record/summary.h"
#include "sim_board/scenario/scenario.h"
#include "simulation/model/robot_model.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/telemetry.h"

namespace koboshi::simulation {

// What happened in a run, when and why, in sentences and as data (docs/reference/events.md). Observes the
// firmware from outside: by the frames on the bus and by the truth of the world.
class EventLog {
 public:
  // More events than these are counted only.
  static constexpr std::size_t kMaxEvents = 2000;

  // Both must outlive the log. `limits` are those of the velocities that the controller obeys.
  EventLog(const sim::Scenario& scenario, const NamedModel& model, const walk::VelocityLimits& limits = {});

  // Each frame at the time of its last bit, after `said` has been read from it.
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t end_us, const Telemetry& said);
  // After each tick. The pushes are all that begin until now, and perhaps later ones, in the order of time.
  void observe_tick(std::uint64_t now_us, const Telemetry& said, const GroundTruth& truth,
                    std::span<const sim::Push> pushes);
  // Adds an event that only the caller knows of.
  void add(std::uint64_t time_us, const std::string& kind, const std::string& text,
           nlohmann::ordered_json fields = nlohmann::ordered_json::object());

  // In the order of time. The last one tells how the run ended, with the verdict as its text.
  std::vector<sim::RunEvent> events(bool controller_is_dead = false) const;
  // "stands; fell once at 3.2 s and got up in 3.4 s; 0 faults".
  std::string verdict(bool controller_is_dead = false) const;
  // How often the trunk fell to a lean of more than 60 degrees; a robot that began so has not fallen.
  std::size_t falls() const { return falls_.size(); }
  // Whether the robot is on its feet, by the lean of its trunk and by what the controller says.
  bool stands() const;
  // The robot's posture at the last tick, in the words of the verdict: "stands", "lies, fault: IMU silent".
  std::string posture(bool controller_is_dead = false) const;
  // The last command and its outcome: "walk: refused, not in this state (limp)". Empty before the first.
  const std::string& last_command() const { return last_command_; }
  // The sentence of the latest event that is no command; empty before the first.
  const std::string& last_text() const { return last_text_; }

  void archive(sim::StateArchive& archive);

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
    behaviour::State state;  // as it was told
  };
  struct EmergencyGroup {
    std::size_t event;
    std::uint64_t last_us;
  };

  void hear_command(behaviour::Command command, std::int16_t argument, std::uint64_t time_us,
                    const Telemetry& said);
  void hear_sdo(const hal::CanFrame& frame, std::uint64_t time_us, const Telemetry& said);
  void hear_emergency(const hal::CanFrame& frame, std::uint64_t time_us);
  void judge_commands(std::uint64_t time_us, const Telemetry& said);
  void judge_velocity(std::uint64_t time_us, const Telemetry& said);
  // Without a refusal, the outcome is not known; Reason::kNone means that the command was obeyed.
  void judge(const GivenCommand& given, std::optional<behaviour::Reason> refusal);
  void follow_state(std::uint64_t time_us, const Telemetry& said);
  void tell_cut_off(std::uint64_t time_us, const Telemetry& said);
  void tell_state(std::uint64_t time_us, const Telemetry& said);
  void follow_truth(std::uint64_t now_us);
  void follow_scenario(std::uint64_t now_us, std::span<const sim::Push> pushes);
  void tell_push(const sim::Push& push);

  std::string motion_name(int number) const;
  std::string node_name(std::uint8_t node) const;
  std::string reason_text(const Telemetry& said) const;
  std::string falls_text() const;

  const sim::Scenario& scenario_;
  const NamedModel& model_;
  const walk::VelocityLimits limits_;
  std::vector<sim::RunEvent> events_;
  std::size_t left_out_ = 0;

  Telemetry said_{};  // at the last tick; and before the present frame, state and motion
  GroundTruth truth_{};
  std::uint64_t now_us_ = 0;
  bool heard_state_ = false;
  std::uint64_t entered_us_ = 0;  // the state

  std::vector<GivenCommand> given_;  // not judged yet
  std::optional<walk::Velocity> velocity_;
  std::optional<std::uint64_t> velocity_us_;  // of one that no command has followed yet
  std::optional<walk::Velocity> told_velocity_;
  std::int16_t sdo_argument_ = 0;
  std::string last_command_;
  std::string last_text_;
  std::size_t refused_ = 0;

  std::map<std::uint16_t, EmergencyGroup> emergencies_;  // by code
  std::vector<Fall> falls_;
  bool is_down_ = false;  // leans more than 60 degrees, until it leans less than 30
  bool was_upright_ = false;
  std::optional<std::uint64_t> down_us_;  // since when the recovery is about
  const char* down_by_ = "";
  std::size_t attempts_ = 0;
  std::vector<std::string> cut_offs_;  // "bow was cut off at 5.31 s"
  std::size_t next_push_ = 0;
  std::vector<bool> begun_;  // faults of the scenario
  std::vector<bool> ended_;
  bool released_ = false;
};

// "  3.210 s  The trunk is pushed ...", a line for each event.
[[nodiscard]] std::string events_text(std::span<const sim::RunEvent> events);

}  // namespace koboshi::simulation
