#pragma once

#include <cstdint>
#include <memory>

#include "sim_board/description/description.h"
#include "sim_board/servo/servo.h"
#include "sim_board/world/world.h"

namespace koboshi::tools {

// The load on the servo of a test bench.
struct RigLoad {
  double inertia_kg_m2 = 1e-4;  // about the shaft, without the weight
  double weight_Nm = 0.0;       // torque of a weight at the end of a level arm; the arm hangs at -pi/2
};

// A servo on a test bench: its case is fixed, an arm turns on its shaft. Uses the physics of the robot.
class ServoRig {
 public:
  static constexpr double kStep_s = 0.0005;

  ServoRig(const sim_board::ServoDescription& servo, const RigLoad& load);

  // Runs the servo's loop for a millisecond, with an external torque on the arm.
  void drive_to(double target_rad, double outer_Nm);
  // The same with a saturated position error: full duty, forward.
  void drive_fully(double outer_Nm);

  double time_s() const { return world_->time_s(); }
  double position_rad() const { return world_->joint(0).position_rad; }
  double speed_rad_per_s() const { return world_->joint(0).speed_rad_per_s; }
  // Torque of the servo on the arm in the last step.
  double output_Nm() const { return world_->joint(0).servo_Nm; }
  const sim_board::Servo& servo() const { return servo_; }

 private:
  void advance(std::int32_t target_units, double outer_Nm);

  double supply_V_;
  sim_board::RobotDescription robot_;
  std::unique_ptr<sim_board::World> world_;
  sim_board::Servo servo_;
};

}  // namespace koboshi::tools
