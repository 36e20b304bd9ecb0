#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "firmware/estimation/posture.h"
#include "firmware/robot/model.h"
#include "hal/port/ankle.h"

namespace koboshi::estimation {

// The ground reaction on one foot.
struct FootPressure {
  fixed::Force load;     // normal to the sole, the foot's weight included; sensor errors may make it negative
  bool contact = false;  // the load is at least a twelfth of the robot's weight
  bool valid = false;    // in contact, and the sensor measures the ZMP
  fixed::Length x;       // of the ZMP in the sole's frame; zero unless valid
  fixed::Length y;
};

// The ZMP of the whole robot.
struct Pressure {
  hal::Side frame = hal::Side::kLeft;  // the sole in whose frame x and y are: that of the foot with more load
  bool valid = false;                  // the foot with more load has a valid ZMP
  fixed::Length x;
  fixed::Length y;
};

// Computes the zero moment point of a foot from its ankle sensor: the paper's equation 1, with f_z as the
// denominator (the paper prints f_x and f_y there, which is not the physics),
//   p_x = (-tau_y - f_x d) / f_z,  p_y = (tau_x - f_y d) / f_z,
// relative to the point of the sole below the sensor, at the distance d. The sensor does not measure the
// weight of the foot below it; it is added as for a foot that is level and at rest, since a foot under load
// nearly is. At a tilt of 5 degrees this is wrong by m g sin(5 deg) d / f_z, 0.3 mm for the default robot on
// one foot.
//
// Four pressure cells at (x_i, y_i) in the sole measure the whole load, that of the foot included:
//   p_x = sum(x_i f_i) / f_z,  p_y = sum(y_i f_i) / f_z,  f_z = sum(f_i).
// This is the same equation for the wrench about the sole's origin, d = 0, and is computed as such.
class FootSensor {
 public:
  // The share of the robot's weight that a foot must bear for its ZMP to be valid, as its reciprocal. Chosen
  // by hand on 2026-11-21: on the default robot it is 1 N, at which the noise of the torques is millimetres
  // of ZMP.
  static constexpr int kWeightPerMinLoad = 12;

  // The model must outlive the sensor.
  FootSensor(const robot::RobotModel& model, hal::Side side);

  using Counts = std::array<std::int16_t, 6>;
  // A count of a quantity that the sensor does not measure.
  static constexpr std::int16_t kNoCount = std::numeric_limits<std::int16_t>::min();

  // Returns the wrench of a sample, as `pressure` takes it: that of a six-axis sensor itself, that of
  // pressure cells about the sole's origin; kNoCount for all other kinds.
  Counts wrench(const hal::AnkleSample& sample) const;
  // Computes load and ZMP of a sensor that measures them. `counts`: the sensor's reading in its axes, force
  // x, y, z, then torque x, y, z, exerted by the ground side on the shank side. The result is rounded once,
  // besides the scaling to LSB of Force and Torque: on the default robot at most 1 um off the formula, at the
  // minimum load.
  FootPressure pressure(std::span<const std::int16_t, 6> counts) const;

 private:
  // Returns the wrench of pressure cells about the sole's origin.
  [[gnu::cold]] Counts cell_wrench(const std::array<std::int16_t, hal::kPressureCells>& cells) const;

  const robot::RobotModel& model_;
  hal::Side side_;
  robot::Position sensor_;  // in the sole's frame
  fixed::Force min_load_;   // that counts as contact
  fixed::Force weight_;     // of the foot
  fixed::Torque weight_x_;  // moment of what carries it, about the sensor
  fixed::Torque weight_y_;
};

// Returns the pressures of feet of which only their contact is known: they bear the weight in equal parts.
hal::BySide<FootPressure> pressures_of(const hal::BySide<bool>& contacts, fixed::Force weight);

// Combines the ZMPs of both feet, weighted by their loads. With one valid foot it is that
// foot's ZMP.
Pressure combine(const hal::BySide<FootPressure>& feet, const Posture& posture);

}  // namespace koboshi::estimation
