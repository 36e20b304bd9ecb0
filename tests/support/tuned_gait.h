#pragma once

#include "firmware/walk/gait.h"

namespace koboshi::test {

// Returns a gait for the test robot: that of robots/koboshi, which has the same proportions.
inline walk::WalkParameters tuned_gait() {
  return {.step = {.time_ms = 220,
                   .double_support = 90,
                   .width = 772,
                   .height = 200,
                   .swing_profile = 800,
                   .acceleration = {300, 200, 1500},
                   .max_forward = 1300,
                   .max_lateral = 1300,
                   .min_lateral = 580},
          .posture = {.com_height = 1675,
                      .zmp_forward = 73,
                      .zmp_inward = -6,
                      .trunk_pitch = 644,
                      .trunk_pitch_by_speed = 382,
                      .pitch_compliance = 1285,
                      .roll_compliance = 399,
                      .arm_swing = -20,
                      .fixed_upper_body = 1},
          .reaction = {.capture_forward = 0,
                       .capture_lateral = 40,
                       .dead_band = 59,
                       .smoothing = 360,
                       .touchdown_load_cN = 0,
                       .heading_hold = 210}};
}

}  // namespace koboshi::test
