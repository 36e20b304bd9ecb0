#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/app/dictionary.h"
#include "firmware/behaviour/behaviour.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/drive/drive_group.h"
#include "firmware/estimation/estimator.h"

namespace koboshi::app {

// The values that motions read from the dictionary.
[[nodiscard]] inline behaviour::BusValues bus_values(const ControllerValues& values) {
  return {.torques_permille = values.drives.torque_permille, .inputs = values.motion.inputs};
}

// Handles what operators request by SDO and PDO: commands, velocities, and parameters that take effect at
// once. Each request is judged and answered when it arrives.
class Requests {
 public:
  // All must outlive this object.
  Requests(ControllerValues& values, robot::RobotModel& model, behaviour::Behaviour& behaviour,
           estimation::Estimator& estimator, const drive::DriveGroup& drives)
      : values_(values),
        model_(model),
        R_BI_(model.R_BI),
        behaviour_(behaviour),
        estimator_(estimator),
        drives_(drives) {}

  // Judges a write to one of the controller's objects by an SDO client, and executes it: the answer to
  // NodeApplication::on_write.
  canopen::AbortCode write(canopen::ObjectAddress address, std::uint32_t value, std::uint64_t now_us);
  // To be called when a PDO has written command and argument, or the velocity, into the dictionary. Return
  // false if an SDO client would be told that the values are invalid: they have no effect.
  [[nodiscard]] bool take_command(std::uint64_t now_us);
  [[nodiscard]] bool take_velocity();
  // Takes the set of joint targets in the dictionary, with its number in the sequence. Returns whether the
  // robot follows it.
  bool take_set(std::uint8_t sequence);

  // Makes every parameter neutral, which has no effect before `apply_parameters`.
  void reset_parameters();
  // Applies all parameters, after a reset.
  void apply_parameters();
  // To be called after each cycle of the estimator: stores the result of a finished gyro calibration in
  // the parameters.
  void end_calibration();

 private:
  canopen::AbortCode execute(behaviour::Command command, std::int16_t argument, std::uint64_t now_us);
  behaviour::Reason request(const walk::Velocity& velocity);
  canopen::AbortCode set_velocity(std::uint8_t subindex, std::int16_t value);
  void set_velocity_limit(std::uint8_t subindex, std::int16_t value);
  canopen::AbortCode set_calibration(canopen::ObjectAddress address, std::int32_t value);
  void begin_stream();
  void count_missing_sets(std::uint8_t sequence);
  void set_trim(std::size_t joint, std::int16_t trim);
  void apply(const Calibration& calibration);

  ControllerValues& values_;
  robot::RobotModel& model_;
  const robot::Rotation R_BI_;  // of the model, without the mounting
  behaviour::Behaviour& behaviour_;
  estimation::Estimator& estimator_;
  const drive::DriveGroup& drives_;
  std::int16_t applied_trims_[robot::kMaxJoints] = {};
  std::optional<std::uint8_t> last_set_;  // of the stream: the highest counter, in its sequence
};

}  // namespace koboshi::app
