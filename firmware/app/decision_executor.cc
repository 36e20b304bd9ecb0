#include "firmware/app/decision_executor.h"

#include "firmware/canopen/cia402.h"

namespace koboshi::app {
namespace {

// Emergency error code of the controller itself: device specific (CiA 301, table 26). State, reason and drive
// fault follow in the manufacturer's field.
constexpr std::uint16_t kErrorBehaviour = 0xFF00;

}  // namespace

// Torque first: an emergency stop waits for nothing.
void DecisionExecutor::execute(const behaviour::Decision& decision, std::uint64_t now_us) {
  drive_enable_.set(decision.drive_enable);
  if (decision.boots != executed_.boots) boot(now_us);
  if (decision.fault && !executed_.fault) report(*decision.fault);
  if (decision.low_battery && !executed_.low_battery)
    node_.raise_error(canopen::cia402::kErrorUnderVoltage, canopen::error_register::kVoltage, {});
  if (!decision.low_battery && executed_.low_battery) node_.clear_error(canopen::cia402::kErrorUnderVoltage);
  if (decision.goals != executed_.goals) drives_.set_goal(decision.goal, now_us);
  executed_ = {decision.boots, decision.goals, decision.fault.has_value(), decision.low_battery};
}

void DecisionExecutor::boot(std::uint64_t now_us) {
  node_.mute(false);
  node_.clear_error(kErrorBehaviour);
  const std::uint64_t reset_us = network_.begin_boot(now_us);
  if (drives_exist_) drives_.boot(reset_us);
  sensor_nodes_.reset();
}

void DecisionExecutor::report(const behaviour::FaultReport& fault) {
  node_.raise_error(kErrorBehaviour, canopen::error_register::kManufacturer,
                    {static_cast<std::uint8_t>(fault.state), static_cast<std::uint8_t>(fault.reason),
                     static_cast<std::uint8_t>(fault.drive_fault.kind), fault.drive_fault.joint, 0});
}

}  // namespace koboshi::app
