#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/behaviour/cycle.h"
#include "firmware/behaviour/fall_detector.h"
#include "firmware/behaviour/motion_player.h"
#include "firmware/behaviour/parameters.h"
#include "firmware/behaviour/rest_detector.h"
#include "firmware/behaviour/state.h"

namespace koboshi::behaviour {

// A fall and getting up: what happens in the states kFalling to kSteadying, and when each of them ends. The
// motions are those of the library, by role; docs/design/getting-up.md explains the order.
class Recovery {
 public:
  // The event that ended a state; kFailure: getting up has failed.
  struct Outcome {
    Event event;
    Reason reason;
  };

  // All must outlive this object.
  Recovery(const robot::RobotModel& model, motion::MotionLibrary& library, MotionPlayer& player,
           const RecoveryParameters& parameters)
      : model_(model), library_(library), player_(player), parameters_(parameters) {}

  // The robot has begun to fall: moves from `targets` into the protective pose for this direction.
  void fall(FallDirection direction, std::span<const fixed::Angle> targets, const motion::Inputs& inputs);
  // Forgets the attempts so far.
  void forget_attempts() { attempts_ = 0; }
  // Restarts the detection of rest. To be called when one of these states begins or the drives go limp,
  // except when a limp robot is commanded to get up.
  void begin_state() { rest_detector_.restart(); }
  // To be called in each cycle in which the robot is limp: if it has lain still, it gets up without settling
  // first.
  void watch_limp(const estimation::RobotState& robot) { rest_detector_.update(robot.rates_B); }

  // One cycle in one of these states, which began `elapsed_us` ago. Writes the targets, one for each joint.
  [[nodiscard]] std::optional<Outcome> run(State state, std::uint64_t elapsed_us, const Cycle& cycle,
                                           const motion::Inputs& inputs, std::span<fixed::Angle> targets);

  // Returns the number of attempts to get up since the robot last stood.
  [[nodiscard]] std::uint8_t attempts() const { return attempts_; }

 private:
  // One cycle of a state.
  struct Step {
    std::uint64_t elapsed_us;  // since the state began
    const Cycle& cycle;
    const motion::Inputs& inputs;
    std::span<fixed::Angle> targets;

    void follow_actual() const;
  };
  using Result = std::optional<Outcome>;

  Result run_falling(const Step& step);
  Result run_fallen(const Step& step);
  Result run_righting(const Step& step);
  Result run_motion(const Step& step);
  Result run_steadying(const Step& step);
  Result turn_from_side(motion::Role roll, Reason side, const Step& step);
  Result rise(motion::Role role, Reason lying, const Step& step);
  Result rise_from_seat(const Step& step);
  fixed::Angle thigh_pitch(const Cycle& cycle) const;
  std::uint32_t pace_percent() const;

  const robot::RobotModel& model_;
  motion::MotionLibrary& library_;
  MotionPlayer& player_;
  const RecoveryParameters& parameters_;
  RestDetector rest_detector_;
  std::uint8_t attempts_ = 0;
  bool has_rolled_ = false;  // in this attempt
};

}  // namespace koboshi::behaviour
