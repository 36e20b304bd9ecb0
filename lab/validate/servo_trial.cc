#include "lab/validate/servo_trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lab/validate/rigs.h"
#include "lab/validate/theory.h"
#include "sim_board/servo/servo.h"

namespace koboshi::lab {
namespace {

constexpr double kLoopPeriod_s = sim_board::PositionController::kPeriod_s;
constexpr double kLever_m = 0.1;

std::int32_t units(double angle_rad) {
  return static_cast<std::int32_t>(std::lround(angle_rad / sim_board::kRadPerPositionUnit));
}

// The derivative of (position, speed) at a constant voltage.
class Motor {
 public:
  Motor(const ServoTrial& trial, double voltage_V, double direction)
      : inertia_(trial.servo.rotor_inertia_kg_m2 + trial.link_inertia_kg_m2),
        torque_Nm_(drive_Nm(trial, voltage_V) - direction * trial.servo.coulomb_friction_Nm),
        damping_(trial.servo.viscous_friction_Nm_s + trial.servo.torque_constant_Nm_per_A *
                                                         trial.servo.torque_constant_Nm_per_A /
                                                         trial.servo.resistance_ohm) {}

  // The torque at rest without friction.
  static double drive_Nm(const ServoTrial& trial, double voltage_V) {
    return trial.load_Nm + trial.servo.torque_constant_Nm_per_A * voltage_V / trial.servo.resistance_ohm;
  }
  Eigen::Vector2d operator()(const Eigen::Vector2d& state) const {
    return {state[1], (torque_Nm_ - damping_ * state[1]) / inertia_};
  }

 private:
  double inertia_;
  double torque_Nm_;
  double damping_;
};

void turn_a_period(Eigen::Vector2d& state, const ServoTrial& trial, double voltage_V) {
  constexpr double kStep_s = 2e-6;
  const double drive_Nm = Motor::drive_Nm(trial, voltage_V);
  for (long i = std::lround(kLoopPeriod_s / kStep_s); i > 0; --i) {
    if (state[1] == 0.0 && std::abs(drive_Nm) <= trial.servo.coulomb_friction_Nm) return;
    const double direction = std::copysign(1.0, state[1] == 0.0 ? drive_Nm : state[1]);
    state = runge_kutta_step(state, kStep_s, Motor(trial, voltage_V, direction));
    if (direction * state[1] < 0.0) state[1] = 0.0;  // at rest: friction may hold it
  }
}

}  // namespace

ServoMotion simulated(const ServoTrial& trial, const ValidationSetup& setup) {
  ValidationSetup weightless = setup;
  weightless.world.gravity_W_m_per_s2.setZero();
  const sim_board::RobotDescription rig =
      chain_rig({{.mass_kg = 0.05, .inertia_kg_m2 = trial.link_inertia_kg_m2, .arm_m = 0.0}});
  const auto world = hang(rig, {0.0}, weightless);
  sim_board::JointDescription joint = rig.joints[0];
  joint.servo = trial.servo;
  joint.encoder.bits = trial.encoder_bits;
  sim_board::Servo servo(joint, {.step_s = world->step_s()});
  ServoMotion motion;
  const long steps = steps_of(kLoopPeriod_s, *world);
  for (long ms = 0; ms < std::lround(trial.duration_s / kLoopPeriod_s); ++ms) {
    servo.sense(world->joint(0));
    servo.drive(units(trial.target_rad(kLoopPeriod_s * static_cast<double>(ms))));
    for (long i = 0; i < steps; ++i) {
      static_cast<void>(servo.draw(world->joint(0)));  // the supply voltage is constant
      world->set_servo(0, servo.torque(trial.servo.supply_V));
      // Perpendicular to a lever that turns with the link.
      const Eigen::Vector3d f_L(-trial.load_Nm / kLever_m, 0.0, 0.0);
      world->push(1, {0.0, 0.0, -kLever_m}, world->body(1).X_WL.linear() * f_L);
      world->step();
    }
    motion.time_s.push_back(kLoopPeriod_s * static_cast<double>(ms + 1));
    motion.position_rad.push_back(world->joint(0).position_rad);
    motion.speed_rad_per_s.push_back(world->joint(0).speed_rad_per_s);
  }
  return motion;
}

ServoMotion reference(const ServoTrial& trial) {
  const double count_rad = 2.0 * std::numbers::pi / std::ldexp(1.0, trial.encoder_bits);
  const double gain_V_per_rad = trial.servo.supply_V / trial.servo.full_voltage_error_rad;
  ServoMotion motion;
  Eigen::Vector2d state = Eigen::Vector2d::Zero();
  for (long ms = 0; ms < std::lround(trial.duration_s / kLoopPeriod_s); ++ms) {
    const double target_rad =
        units(trial.target_rad(kLoopPeriod_s * static_cast<double>(ms))) * sim_board::kRadPerPositionUnit;
    const double measured_rad = std::floor(state[0] / count_rad + 0.5) * count_rad;
    const double voltage_V =
        std::clamp(gain_V_per_rad * (target_rad - measured_rad), -trial.servo.supply_V, trial.servo.supply_V);
    turn_a_period(state, trial, voltage_V);
    motion.time_s.push_back(kLoopPeriod_s * static_cast<double>(ms + 1));
    motion.position_rad.push_back(state[0]);
    motion.speed_rad_per_s.push_back(state[1]);
  }
  return motion;
}

double steady_speed_rad_per_s(const sim_board::ServoDescription& servo, double load_Nm) {
  const double kt = servo.torque_constant_Nm_per_A;
  return (kt * servo.supply_V / servo.resistance_ohm + load_Nm - servo.coulomb_friction_Nm) /
         (kt * kt / servo.resistance_ohm + servo.viscous_friction_Nm_s);
}

}  // namespace koboshi::lab
