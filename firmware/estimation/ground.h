#pragma once

#include "firmware/estimation/posture.h"
#include "firmware/estimation/zmp.h"
#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// The slope of the ground under a robot that stands, and the error of the attitude's zero. Slopes are
// tangents along the sole's axes: positive x where the ground rises ahead, positive y where it rises to the
// left.
struct Ground {
  bool valid = false;
  fixed::Ratio slope_x;
  fixed::Ratio slope_y;
  // The part of the attitude beyond the slope.
  fixed::Ratio zero_x;
  fixed::Ratio zero_y;
};

// Estimates the slope by two measurements of a robot that stands still on one foot or both. In the frame of
// the sole, gravity points from the centre of mass r to the centre of pressure c, and it points as the
// attitude says:
//
//   s_c = (r - c) / r_z = slope + (offset of the CoM) / r_z,   s_a = slope + (bias of the accelerometer) / g.
//
// Observable are these two sums only: slope, bias and offset are three unknowns. The bias is up to 50 mg,
// uniform (MPU-6050, section 6.2): a standard deviation of 1.65 degrees. An offset of 5 mm, uniform, at a CoM
// 0.164 m high is 1.0 degree. Weighted by the inverse of these variances the estimate has 0.86 degrees, and
//
//   slope = s_a + kPressureShare (s_c - s_a).
//
// Their difference, which is bias less offset, goes to the attitude's zero.
class GroundEstimator {
 public:
  // Takes a cycle of 10 ms of a robot that stands still. The first one sets the estimate; the later ones
  // smooth it, with a time constant of 0.3 s.
  const Ground& update(const Posture& posture, const robot::Direction& up_B, const Pressure& zmp);
  // The robot moves: the estimate stays.
  const Ground& ground() const { return ground_; }

 private:
  Ground ground_;
};

}  // namespace koboshi::estimation
