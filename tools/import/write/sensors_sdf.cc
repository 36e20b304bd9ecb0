#include "tools/import/write/sensors_sdf.h"

#include <cmath>

#include <fmt/format.h>

namespace koboshi::tools {

std::string imu_sdf(const std::string& pose) {
  return fmt::format(R"(      <!-- InvenSense MPU-6050 class, as in robots/koboshi/robot.sdf. -->
      <sensor name="imu" type="imu">
        <pose>{}</pose>
        <update_rate>1000</update_rate>
        <koboshi:gyro>
          <noise_density>8.72665e-05</noise_density>
          <bias>0.349066</bias>
          <bias_instability>3.15e-05</bias_instability>
          <random_walk>1.15e-06</random_walk>
          <scale_error>0.03</scale_error>
          <cross_axis>0.02</cross_axis>
          <g_sensitivity>0.00017797</g_sensitivity>
          <bandwidth_Hz>98</bandwidth_Hz>
          <range>17.4533</range>
          <resolution>0.000532632</resolution>
          <delay_s>0.001</delay_s>
        </koboshi:gyro>
        <koboshi:accelerometer>
          <noise_density>0.00392266</noise_density>
          <bias>0.490333</bias>
          <bias_instability>0.00059</bias_instability>
          <random_walk>2.15e-05</random_walk>
          <scale_error>0.03</scale_error>
          <cross_axis>0.02</cross_axis>
          <bandwidth_Hz>98</bandwidth_Hz>
          <range>39.2266</range>
          <resolution>0.0011971</resolution>
          <delay_s>0.001</delay_s>
        </koboshi:accelerometer>
      </sensor>
)",
                     pose);
}

std::string ankle_sensor_sdf(const std::string& side, double weight_N) {
  // The default robot of 11.8 N has 100 N and 4 N m, which steps and falls do not exceed.
  const double force_N = 10.0 * std::ceil(8.5 * weight_N / 10.0);
  const double torque_Nm = std::ceil(0.34 * weight_N);
  return fmt::format(
      R"(      <!-- Ranges in proportion to the robot's weight, errors as in robots/koboshi/robot.sdf. -->
      <sensor name="{}_ankle" type="force_torque">
        <pose>0 0 0 0 0 0</pose>
        <update_rate>1000</update_rate>
        <force_torque><frame>sensor</frame><measure_direction>child_to_parent</measure_direction></force_torque>
        <koboshi:force>
          <noise_density>{:.4g}</noise_density>
          <bias>{:.4g}</bias>
          <cross_axis>0.005</cross_axis>
          <bandwidth_Hz>98</bandwidth_Hz>
          <range>{:.4g}</range>
          <resolution>{:.4g}</resolution>
          <delay_s>0.001</delay_s>
        </koboshi:force>
        <koboshi:torque>
          <noise_density>{:.4g}</noise_density>
          <bias>{:.4g}</bias>
          <cross_axis>0.005</cross_axis>
          <bandwidth_Hz>98</bandwidth_Hz>
          <range>{:.4g}</range>
          <resolution>{:.4g}</resolution>
          <delay_s>0.001</delay_s>
        </koboshi:torque>
        <koboshi:crosstalk>0.005</koboshi:crosstalk>
      </sensor>
)",
      side, 1e-5 * force_N, 5e-4 * force_N, force_N, force_N / 20000.0, 5e-6 * torque_Nm, 2.5e-4 * torque_Nm,
      torque_Nm, torque_Nm / 20000.0);
}

}  // namespace koboshi::tools
