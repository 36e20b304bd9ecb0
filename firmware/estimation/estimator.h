#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/estimation/attitude.h"
#include "firmware/estimation/gyro_bias.h"
#include "firmware/estimation/inertial.h"
#include "firmware/estimation/robot_state.h"
#include "firmware/estimation/zmp.h"
#include "firmware/robot/model.h"
#include "hal/port/ankle.h"
#include "hal/port/imu.h"

namespace koboshi::estimation {

// The first stage of a control cycle: samples go in as they come, a RobotState comes out each 10 ms. It
// filters the inertial samples (second order, 20 Hz), measures the gyro's bias whenever the robot rests,
// and computes attitude, ZMP and centre of mass.
class Estimator {
 public:
  using Rates = InertialSensor::Rates;

  // The outcome of a calibration that was begun.
  enum class Calibration : std::uint8_t {
    kNone,  // none has ended in this cycle
    kDone,  // gyro_bias() is the new one
    kMoved  // the robot did not rest; the old bias stays
  };

  // The model must outlive the estimator; its R_BI may change between the cycles.
  explicit Estimator(const robot::RobotModel& model);

  // The next sample of the inertial unit, at 1 kHz.
  void add(const hal::ImuSample& sample, std::uint64_t now_us) { inertial_.add(sample, now_us); }
  // The latest sample of an ankle sensor.
  void add(hal::Side side, const hal::AnkleSample& sample, std::uint64_t now_us);

  // Ends a control cycle of 10 ms. `angles`: one a joint, as measured. `rests`: the robot makes no torque, so
  // that nothing but a hand moves it. The reference is good until the next call.
  const RobotState& update(std::span<const fixed::Angle> angles, bool rests, std::uint64_t now_us);
  // Of the last cycle.
  const RobotState& state() const { return state_; }

  // A bias that is known from elsewhere, in force until the next second of rest; zero is none.
  void assume_gyro_bias(const Rates& bias_B);
  // The next second is a calibration; its end shows in `calibration`. Should the robot not rest in it, it
  // fails.
  void begin_calibration();
  Calibration calibration() const { return calibration_; }
  const Rates& gyro_bias() const { return gyro_bias_.bias(); }
  // Seconds of rest that gave a bias, since power-on; saturates.
  std::uint16_t gyro_calibrations() const { return gyro_calibrations_; }

 private:
  void update_gyro_bias(const Rates& raw_B, bool rests);
  void update_attitude(bool rests);
  void update_balance(std::span<const fixed::Angle> angles);
  void update_ages(std::uint64_t now_us);

  const robot::RobotModel& model_;
  InertialSensor inertial_;
  GyroBias gyro_bias_;
  AttitudeEstimator attitude_;
  hal::BySide<FootSensor> foot_sensors_;
  hal::BySide<std::array<std::int16_t, 6>> wrenches_{};  // counts: force, then torque
  hal::BySide<std::optional<std::uint64_t>> ankle_us_;   // when each was heard last
  bool calibrating_ = false;
  bool bias_assumed_ = false;
  std::uint16_t gyro_calibrations_ = 0;
  Calibration calibration_ = Calibration::kNone;
  RobotState state_;
};

}  // namespace koboshi::estimation
