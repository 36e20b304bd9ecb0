#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/estimation/attitude.h"
#include "firmware/estimation/centre_of_mass.h"
#include "firmware/estimation/gyro_bias.h"
#include "firmware/estimation/inertial.h"
#include "firmware/estimation/inertial_link.h"
#include "firmware/estimation/robot_state.h"
#include "firmware/estimation/torque_contact.h"
#include "firmware/estimation/zmp.h"
#include "firmware/robot/model.h"
#include "hal/port/ankle.h"
#include "hal/port/imu.h"

namespace koboshi::estimation {

// The first stage of a control cycle: takes samples as they arrive and computes a RobotState each 10 ms. It
// filters the inertial samples (second order, 20 Hz), measures the gyro's bias while the robot rests, and
// estimates attitude, ZMP and centre of mass. The attitude integrates the unfiltered samples, because the
// filter's delay would be an error of the angle; the rates that the feedback uses are the filtered ones.
class Estimator {
 public:
  using Rates = InertialSensor::Rates;

  // The outcome of a calibration.
  enum class Calibration : std::uint8_t {
    kNone,  // none ended in this cycle
    kDone,  // gyro_bias() is new
    kMoved  // the robot moved; the bias is unchanged
  };

  // The model must outlive the estimator; its R_BI may change between cycles.
  explicit Estimator(const robot::RobotModel& model);

  // Takes the next sample of the inertial unit, at 1 kHz.
  void add(const hal::ImuSample& sample, std::uint64_t now_us) { inertial_.add(sample, now_us); }
  // Takes the latest sample of an ankle sensor.
  void add(hal::Side side, const hal::AnkleSample& sample, std::uint64_t now_us);

  // Computes the state of a control cycle of 10 ms. `angles`: measured, one for each joint. `rests`: the
  // drives make no torque. `legs`: for a robot without sensors in its feet. The reference stays valid until
  // the next call.
  const RobotState& update(std::span<const fixed::Angle> angles, bool rests, std::uint64_t now_us,
                           const LegEvidence& legs = {});
  // Returns the state of the last cycle.
  const RobotState& state() const { return state_; }
  // Returns the latest wrench of an ankle sensor (FootSensor::wrench).
  const FootSensor::Counts& wrench(hal::Side side) const { return wrenches_[side]; }

  // Sets a stored bias, in axes of B, valid until the next measurement; zero means that none is stored.
  void assume_gyro_bias(const Rates& bias_B);
  // Starts a calibration, which takes the next second; `calibration` returns its outcome in the cycle in
  // which it ends. It fails if the robot moves.
  void begin_calibration();
  Calibration calibration() const { return calibration_; }
  const Rates& gyro_bias() const { return gyro_bias_.bias(); }
  // Returns the number of measured biases since power-on; saturates.
  std::uint16_t gyro_calibrations() const { return gyro_calibrations_; }

 private:
  void update_gyro_bias(const Rates& raw_B, bool rests);
  // Returns the rotation vector since the last cycle of the link that carries the inertial unit, in rad.
  robot::Vector<fixed::Ratio> update_attitude(bool rests);
  // Converts attitude, rates and accelerations from the link of the inertial unit to the trunk, and returns
  // the trunk's rotation vector.
  [[gnu::cold]] robot::Vector<fixed::Ratio> convert_to_trunk(std::span<const fixed::Angle> angles);
  void update_balance(std::span<const fixed::Angle> angles, bool rests, const LegEvidence& legs);
  void update_feet(const LegEvidence& legs);
  [[nodiscard]] hal::Side standing_foot(const LegEvidence& legs) const;
  void update_ages(std::uint64_t now_us);
  void update_contacts();

  const robot::RobotModel& model_;
  InertialSensor inertial_;
  GyroBias gyro_bias_;
  AttitudeEstimator attitude_;  // of the link that carries the unit, in axes of B at joint zero
  InertialLink inertial_link_;
  hal::BySide<FootSensor> foot_sensors_;
  hal::BySide<FootSensor::Counts> wrenches_{};          // force x, y, z, then torque
  hal::BySide<std::optional<std::uint64_t>> ankle_us_;  // time of each one's last sample
  hal::BySide<bool> switches_{};                        // closed; of contact switches
  TorqueContact torque_contact_;                        // of a robot without ankle sensors
  CentreOfMassObserver com_;
  Odometry odometry_;
  GroundEstimator ground_;
  fixed::Force weight_;
  hal::BySide<ContactWatch> contacts_;
  bool calibrating_ = false;
  bool bias_assumed_ = false;
  std::uint16_t gyro_calibrations_ = 0;
  Calibration calibration_ = Calibration::kNone;
  RobotState state_;
};

}  // namespace koboshi::estimation
