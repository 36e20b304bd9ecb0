#pragma once

#include <cstdint>
#include <span>

#include "firmware/app/dictionary.h"
#include "firmware/behaviour/behaviour.h"
#include "firmware/canopen/node/node.h"
#include "firmware/estimation/robot_state.h"
#include "firmware/policy/policy_slot.h"
#include "firmware/policy/residual.h"
#include "firmware/robot/model.h"

namespace koboshi::app {

// Runs the policy in storage as a residual on the walk: its offsets are added to the targets of the walker,
// before the feedback and the joints' limits. Shows what it does in object 0x2150, and sends an emergency
// message when the watchdog stops it.
class PolicyControl {
 public:
  // All must outlive the control.
  PolicyControl(policy::PolicySlot& slot, const robot::RobotModel& model, ControllerValues& values,
                canopen::Node& node)
      : slot_(slot), model_(model), values_(values), node_(node) {}

  // One control cycle, after the behaviour's. Without a policy in use it takes a few instructions.
  void step(const behaviour::Behaviour& behaviour, const estimation::RobotState& robot,
            std::span<const fixed::Angle> angles) {
    if (values_.policy.enabled != 0 || in_use_) run(behaviour, robot, angles);
  }
  // Adds the offsets to the targets of their joints.
  void add_to(std::span<fixed::Angle> targets) const {
    if (residual_.active()) residual_.add_to(targets);
  }
  [[nodiscard]] const policy::Residual& residual() const { return residual_; }
  [[nodiscard]] policy::Residual& residual() { return residual_; }

 private:
  void run(const behaviour::Behaviour& behaviour, const estimation::RobotState& robot,
           std::span<const fixed::Angle> angles);
  void walk(const policy::Policy& policy, const behaviour::Behaviour& behaviour,
            const estimation::RobotState& robot, std::span<const fixed::Angle> angles);
  void rest(const policy::Policy* policy, bool has_torque);
  void report_stop();
  [[nodiscard]] PolicyState resting_state(const policy::Policy* policy) const;

  policy::PolicySlot& slot_;
  const robot::RobotModel& model_;
  ControllerValues& values_;
  canopen::Node& node_;
  policy::Residual residual_;
  bool in_use_ = false;  // was enabled in the last cycle, or has offsets
  bool walks_ = false;   // the policy has run in the last cycle
  bool stopped_ = false;
  std::uint8_t changes_ = 0;  // of the slot, as seen last
};

}  // namespace koboshi::app
