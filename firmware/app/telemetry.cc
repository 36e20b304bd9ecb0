#include "firmware/app/telemetry.h"

#include <optional>

#include "firmware/app/telemetry_units.h"
#include "firmware/fixed/radians.h"

namespace koboshi::app {
namespace {

constexpr std::uint8_t kPlanFlags = kPlannedZmpValid | kPlanIsInRight;

// Replaces the bits of the mask; the other stage's stay.
void set_flags(std::uint8_t& flags, std::uint8_t mask, int value) {
  flags = static_cast<std::uint8_t>((flags & ~mask) | value);
}

int contact_flags(const estimation::RobotState& robot) {
  if (robot.measures_loads) return 0;
  return (robot.feet[0].contact ? kLeftContact : 0) | (robot.feet[1].contact ? kRightContact : 0);
}

void show(const std::optional<walk::PlannedZmp>& planned, ControllerValues& values) {
  auto& balance = values.balance;
  const walk::Point p = planned ? planned->p : walk::Point();
  balance.planned_zmp[0] = narrow(p.x);
  balance.planned_zmp[1] = narrow(p.y);
  const bool in_right = planned && planned->sole == hal::Side::kRight;
  set_flags(balance.flags, kPlanFlags, (planned ? kPlannedZmpValid : 0) | (in_right ? kPlanIsInRight : 0));
}

void show_motion(const estimation::RobotState& robot, ControllerValues& values) {
  const estimation::CentreOfMassMotion& motion = robot.com;
  auto& com = values.com;
  com.position[0] = narrow(motion.position.x);
  com.position[1] = narrow(motion.position.y);
  com.velocity[0] = thousandths(motion.velocity.x);
  com.velocity[1] = thousandths(motion.velocity.y);
  com.dcm[0] = narrow(motion.dcm.x);
  com.dcm[1] = narrow(motion.dcm.y);
  set_flags(com.flags, static_cast<std::uint8_t>(~kDcmErrorValid),
            (motion.valid ? kComValid : 0) | (motion.sole == hal::Side::kRight ? kComIsInRight : 0) |
                (robot.contacts[0].touches ? kLeftTouches : 0) |
                (robot.contacts[1].touches ? kRightTouches : 0));
}

void show(const estimation::RobotState& robot, decltype(ControllerValues::place)& place) {
  // A slope of 10 degrees is 1 % steeper as an angle than as its tangent.
  const auto angle = [](fixed::Ratio tangent) { return narrow(fixed::from_rad(tangent)); };
  place.position[0] = thousandths(robot.odometer.x);
  place.position[1] = thousandths(robot.odometer.y);
  place.heading = narrow(robot.odometer.heading);
  place.slope[0] = angle(robot.ground.slope_x);
  place.slope[1] = angle(robot.ground.slope_y);
  place.attitude_zero[0] = angle(robot.ground.zero_x);
  place.attitude_zero[1] = angle(robot.ground.zero_y);
  place.flags = robot.ground.valid ? kGroundValid : 0;
  for (std::size_t foot = 0; foot < robot.contacts.size(); ++foot)
    place.contact_ms[foot] = fixed::saturate<std::uint16_t>(robot.contacts[foot].since_us / 1'000);
}

void show_error(const std::optional<walk::Point>& dcm_error, ControllerValues& values) {
  const walk::Point error = dcm_error.value_or(walk::Point());
  values.com.dcm_error[0] = narrow(error.x);
  values.com.dcm_error[1] = narrow(error.y);
  set_flags(values.com.flags, kDcmErrorValid, dcm_error ? kDcmErrorValid : 0);
}

}  // namespace

void show(const estimation::RobotState& robot, ControllerValues& values) {
  auto& attitude = values.attitude;
  attitude.roll = narrow(robot.roll);
  attitude.pitch = narrow(robot.pitch);
  narrow(robot.rates_B, attitude.rate);
  narrow(robot.accelerations_B, attitude.acceleration);

  auto& balance = values.balance;
  // A robot that never measures a ZMP has no value, which is not the same as an origin under no load.
  const auto show_zmp = [&](fixed::Length x, fixed::Length y, std::int16_t(&shown)[2]) {
    shown[0] = robot.measures_loads ? narrow(x) : kNoLength;
    shown[1] = robot.measures_loads ? narrow(y) : kNoLength;
  };
  for (std::size_t side = 0; side < robot.feet.size(); ++side)
    show_zmp(robot.feet[side].x, robot.feet[side].y, balance.foot_zmp[side]);
  show_zmp(robot.zmp.x, robot.zmp.y, balance.zmp);
  narrow(robot.centre_of_mass, balance.com);
  set_flags(balance.flags, static_cast<std::uint8_t>(~kPlanFlags),
            (robot.feet[0].valid ? kLeftZmpValid : 0) | (robot.feet[1].valid ? kRightZmpValid : 0) |
                (robot.zmp.valid ? kZmpValid : 0) |
                (robot.zmp.frame == hal::Side::kRight ? kFrameIsRight : 0) | contact_flags(robot));
  show_motion(robot, values);
  show(robot, values.place);
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
  values.velocity = behaviour.velocity();
  values.supply = {.open_circuit_mV = behaviour.supply().open_circuit_mV(),
                   .load_sag_mV = behaviour.supply().load_sag_mV()};
  show(behaviour.decision().planned_zmp, values);
  show_error(behaviour.decision().dcm_error, values);
  values.diagnosis.falls = status.falls;
  values.diagnosis.risen = status.risen;
}

}  // namespace koboshi::app
