#pragma once

#include <string_view>

#include "firmware/canopen/dictionary.h"

namespace koboshi::simulation {

// The name of an object of the controller in parameter files, scenarios and studies. Its end names the unit.
struct ParameterKey {
  canopen::ObjectAddress address;
  std::string_view key;
};

// All of them, in the order of the dictionary.
inline constexpr ParameterKey kParameterKeys[] = {
    {{0x1F80, 0x00}, "nmt_startup"},
    {{0x2100, 0x01}, "lowest_supply_mV"},
    {{0x2100, 0x02}, "highest_supply_mV"},
    {{0x2100, 0x03}, "ramp_rate_deg_per_s"},
    {{0x2100, 0x04}, "low_supply_mV"},
    {{0x2101, 0x01}, "ankle_pitch_gain_s"},
    {{0x2101, 0x02}, "ankle_roll_gain_s"},
    {{0x2101, 0x03}, "hip_roll_gain_s"},
    {{0x2101, 0x04}, "knee_gain_s"},
    {{0x2101, 0x05}, "hip_pitch_gain_s"},
    {{0x2102, 0x01}, "standing_gain_ankle_pitch_s"},
    {{0x2102, 0x02}, "standing_gain_ankle_roll_s"},
    {{0x2102, 0x03}, "standing_gain_hip_roll_s"},
    {{0x2102, 0x04}, "standing_gain_knee_s"},
    {{0x2102, 0x05}, "standing_gain_hip_pitch_s"},
    {{0x2103, 0x01}, "standing_lean_gain_ankle_pitch_percent"},
    {{0x2103, 0x02}, "standing_lean_gain_ankle_roll_percent"},
    {{0x2103, 0x03}, "standing_lean_gain_hip_roll_percent"},
    {{0x2103, 0x04}, "standing_lean_gain_knee_percent"},
    {{0x2103, 0x05}, "standing_lean_gain_hip_pitch_percent"},
    {{0x2104, 0x01}, "walking_gain_ankle_pitch_s"},
    {{0x2104, 0x02}, "walking_gain_ankle_roll_s"},
    {{0x2104, 0x03}, "walking_gain_hip_roll_s"},
    {{0x2104, 0x04}, "walking_gain_knee_s"},
    {{0x2104, 0x05}, "walking_gain_hip_pitch_s"},
    {{0x2105, 0x01}, "walking_lean_gain_ankle_pitch_percent"},
    {{0x2105, 0x02}, "walking_lean_gain_ankle_roll_percent"},
    {{0x2105, 0x03}, "walking_lean_gain_hip_roll_percent"},
    {{0x2105, 0x04}, "walking_lean_gain_knee_percent"},
    {{0x2105, 0x05}, "walking_lean_gain_hip_pitch_percent"},
    {{0x2106, 0x01}, "standing_dead_band_deg_per_s"},
    {{0x2111, 0x01}, "highest_velocity_forward_mm_per_s"},
    {{0x2111, 0x02}, "highest_velocity_backward_mm_per_s"},
    {{0x2111, 0x03}, "highest_velocity_lateral_mm_per_s"},
    {{0x2111, 0x04}, "highest_turn_mrad_per_s"},
    {{0x2121, 0x01}, "mounting_roll_deg"},
    {{0x2121, 0x02}, "mounting_pitch_deg"},
    {{0x2121, 0x03}, "mounting_yaw_deg"},
    {{0x2122, 0x01}, "known_gyro_bias_x_deg_per_s"},
    {{0x2122, 0x02}, "known_gyro_bias_y_deg_per_s"},
    {{0x2122, 0x03}, "known_gyro_bias_z_deg_per_s"},
    {{0x2130, 0x01}, "step_time_ms"},
    {{0x2130, 0x02}, "double_support_percent"},
    {{0x2130, 0x03}, "step_width_mm"},
    {{0x2130, 0x04}, "step_height_mm"},
    {{0x2130, 0x05}, "swing_profile_percent"},
    {{0x2130, 0x06}, "acceleration_forward_mm_per_s2"},
    {{0x2130, 0x07}, "acceleration_lateral_mm_per_s2"},
    {{0x2130, 0x08}, "acceleration_turn_mrad_per_s2"},
    {{0x2130, 0x09}, "longest_step_mm"},
    {{0x2130, 0x0A}, "widest_step_mm"},
    {{0x2130, 0x0B}, "narrowest_step_mm"},
    {{0x2131, 0x01}, "com_height_mm"},
    {{0x2131, 0x02}, "zmp_forward_mm"},
    {{0x2131, 0x03}, "zmp_inward_mm"},
    {{0x2131, 0x04}, "trunk_pitch_deg"},
    {{0x2131, 0x05}, "trunk_pitch_by_speed_deg_s_per_m"},
    {{0x2131, 0x06}, "pitch_compliance_rad_per_m"},
    {{0x2131, 0x07}, "roll_compliance_rad_per_m"},
    {{0x2131, 0x08}, "arm_swing_rad_per_m"},
    {{0x2131, 0x09}, "fixed_upper_body"},
    {{0x2132, 0x01}, "capture_forward_percent"},
    {{0x2132, 0x02}, "capture_lateral_percent"},
    {{0x2132, 0x03}, "capture_dead_band_mm"},
    {{0x2132, 0x04}, "capture_smoothing_percent"},
    {{0x2132, 0x05}, "touchdown_load_N"},
    {{0x2132, 0x06}, "heading_hold_percent"},
    {{0x2140, 0x01}, "fall_to_the_front_deg"},
    {{0x2140, 0x02}, "fall_to_the_back_deg"},
    {{0x2140, 0x03}, "fall_to_the_side_deg"},
    {{0x2140, 0x04}, "fall_lead_ms"},
    {{0x2140, 0x05}, "smallest_lean_of_a_fall_deg"},
    {{0x2140, 0x06}, "cycles_of_a_fall"},
    {{0x2140, 0x07}, "largest_declared_lean_deg"},
    {{0x2141, 0x01}, "attempts_to_get_up"},
    {{0x2141, 0x02}, "slower_attempts_percent"},
};

}  // namespace koboshi::simulation
