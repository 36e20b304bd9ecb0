#pragma once

#include "firmware/walk/gait.h"

namespace koboshi::test {

// Returns a gait for the test robot: that of robots/koboshi, which has the same proportions.
inline walk::WalkParameters tuned_gait() {
  return {.step = {.time_ms = 170,
                   .double_support = 20,
                   .width = 768,
                   .height = 277,
                   .swing_profile = 520,
                   .acceleration = {600, 300, 3000},
                   .max_forward = 1300,
                   .max_lateral = 1500,
                   .min_lateral = 580,
                   .lengthening = 150,
                   .forward_offset = 70},
          .posture = {.com_height = 1610,
                      .zmp_forward = 110,
                      .zmp_inward = -6,
                      .trunk_pitch = 950,
                      .trunk_pitch_by_speed = 382,
                      .pitch_compliance = 1285,
                      .roll_compliance = 399,
                      .arm_swing = -20,
                      .fixed_upper_body = 1},
          .reaction = {.capture_forward = 500,
                       .capture_lateral = 400,
                       .dead_band = 104,
                       .smoothing = 0,
                       .touchdown_load_cN = 0,
                       .heading_hold = 210,
                       .plan_age_ms = 50,
                       .level_swing = 780,
                       .zmp_tracking_forward = 1030,
                       .zmp_tracking_lateral = 1030,
                       .max_zmp_shift_forward = 500,
                       .max_zmp_shift_lateral = 120,
                       .max_standing_dcm = 370,
                       .pushed_step_time_ms = 140,
                       .arm_reaction = 6000}};
}

}  // namespace koboshi::test
