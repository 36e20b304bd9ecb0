#include "firmware/app/telemetry.h"

#include "firmware/app/telemetry_units.h"

namespace koboshi::app {

void show(const estimation::RobotState& robot, ControllerValues& values) {
  auto& attitude = values.attitude;
  attitude.roll = narrow(robot.roll);
  attitude.pitch = narrow(robot.pitch);
  narrow(robot.rates_B, attitude.rate);
  narrow(robot.accelerations_B, attitude.acceleration);

  auto& balance = values.balance;
  for (std::size_t side = 0; side < robot.feet.size(); ++side) {
    balance.foot_zmp[side][0] = narrow(robot.feet[side].x);
    balance.foot_zmp[side][1] = narrow(robot.feet[side].y);
  }
  balance.zmp[0] = narrow(robot.zmp.x);
  balance.zmp[1] = narrow(robot.zmp.y);
  narrow(robot.centre_of_mass, balance.com);
  balance.flags = static_cast<std::uint8_t>(
      (robot.feet[0].valid ? kLeftZmpValid : 0) | (robot.feet[1].valid ? kRightZmpValid : 0) |
      (robot.zmp.valid ? kZmpValid : 0) | (robot.zmp.frame == hal::Side::kRight ? kFrameIsRight : 0));
}

void show(const estimation::Estimator& estimator, ControllerValues& values) {
  values.diagnosis.gyro_calibrations = estimator.gyro_calibrations();
  if (estimator.gyro_calibrations() != 0) narrow(estimator.gyro_bias(), values.diagnosis.gyro_bias);
}

void show(const behaviour::Behaviour& behaviour, ControllerValues& values) {
  const behaviour::Status& status = behaviour.status();
  values.behaviour = {.state = status.state,
                      .reason = status.reason,
                      .motion = status.motion,
                      .drive_fault = status.drive_fault.kind,
                      .faulty_joint = status.drive_fault.joint,
                      .drive_error_code = status.drive_fault.error_code,
                      .faults = status.faults,
                      .refusal = status.refusal,
                      .attempts = status.attempts,
                      .overlay = status.overlay};
  values.diagnosis.falls = status.falls;
  values.diagnosis.risen = status.risen;
}

}  // namespace koboshi::app
