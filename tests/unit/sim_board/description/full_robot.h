#pragma once

#include <string>

#include "tests/unit/sim_board/description/small_robot.h"

namespace koboshi::sim_board {

// A robot that has every key of the table (robot_keys.h) at least once, each optional one with another value
// than its default; without the older keys for which SDF 1.9 has others. FULL_MESH stands for the path of a
// mesh.
inline const std::string kFullRobot =
    R"(<sdf version="1.9" xmlns:koboshi="https://koboshi.invalid/sdf">
  <model name="full" canonical_link="base" placement_frame="mount">
    <pose>0 0 0.1 0 0 0</pose>
    <frame name="mount" attached_to="base"><pose relative_to="base">0 0 0.02 0 0 0.2</pose></frame>
    <frame name="tip"><pose relative_to="mount">0 0 0.03 0 0 0</pose></frame>
    <koboshi:servo_types file="FULL_LIBRARY"/>
    <koboshi:servo_type name="small">
)" + kServoNumbers +
    R"(      <velocity_gain_V_s_per_rad>0.2</velocity_gain_V_s_per_rad>
)" + kServoEffects +
    R"(      <voltmeter lowest_V="0" highest_V="15" resolution_V="0.02" noise_V="0.01" offset_V="0.03"
                 scale_error="0.04" sample_period_s="0.2"/>
      <thermometer lowest_C="-40" highest_C="125" resolution_K="0.5" noise_K="0.2" offset_K="2"
                   scale_error="0.05" sample_period_s="0.1"/>
    </koboshi:servo_type>
    <koboshi:battery open_circuit_V="7.8" internal_resistance_ohm="0.05"/>
    <link name="foot">
      <pose relative_to="mount">0 0 -0.12 0 0 0.1</pose>
      <inertial>
        <pose>0 0 0.05 0.1 0 0</pose>
        <mass>0.1</mass>
        <inertia>
          <ixx>2e-4</ixx><iyy>3e-4</iyy><izz>4e-4</izz><ixy>1e-6</ixy><ixz>2e-6</ixz><iyz>3e-6</iyz>
        </inertia>
      </inertial>
      <collision name="sole">
        <pose relative_to="foot">0 0 0.05 0 0 0.2</pose>
        <geometry><box><size>0.02 0.03 0.1</size></box></geometry>
        <surface>
          <friction><ode><mu>0.7</mu><mu2>0.6</mu2><fdir1>0 1 0</fdir1></ode></friction>
          <bounce><restitution_coefficient>0.3</restitution_coefficient><threshold>0.05</threshold></bounce>
          <contact><ode><soft_cfm>2e-5</soft_cfm><soft_erp>0.4</soft_erp></ode></contact>
          <koboshi:reference_step_s>0.002</koboshi:reference_step_s>
          <koboshi:material>rubber</koboshi:material>
        </surface>
      </collision>
      <visual name="shell">
        <pose relative_to="foot">0 0 0.01 0 0 0.3</pose>
        <geometry><mesh><uri>FULL_MESH</uri><scale>0.001 0.002 0.003</scale></mesh></geometry>
        <material>
          <diffuse>0.1 0.2 0.3 1</diffuse>
          <ambient>1 1 1 1</ambient><specular>0 0 0 1</specular><emissive>0 0 0 1</emissive>
          <render_order>1</render_order><lighting>true</lighting>
          <double_sided>false</double_sided><script><uri>a</uri><name>b</name></script>
          <shader type="pixel"/><pbr/>
        </material>
      </visual>
    </link>
    <link name="base">
      <pose relative_to="__model__">0 0 0.3 0 0 0</pose>
      <inertial>
        <mass>0.2</mass>
        <inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia>
      </inertial>
      <visual name="case">
        <pose relative_to="mount">0 0 0.01 0 0 0</pose>
        <geometry><box><size>0.1 0.2 0.3</size></box></geometry>
      </visual>
      <collision name="guard">
        <pose relative_to="tip">0 0 0.01 0 0 0</pose>
        <geometry><box><size>0.1 0.2 0.3</size></box></geometry>
        <surface>
          <friction><ode><mu>0.7</mu></ode></friction>
          <contact><ode><soft_cfm>2e-5</soft_cfm><soft_erp>0.4</soft_erp></ode></contact>
        </surface>
      </collision>
      <sensor name="imu" type="imu">
        <pose relative_to="base">0.01 0 0 0 0 0.4</pose>
        <update_rate>1000</update_rate>
        <koboshi:jitter_s>0.0001</koboshi:jitter_s>
        <koboshi:gyro>
          <noise_density>1e-4</noise_density><bias>0.1</bias><bias_instability>1e-5</bias_instability>
          <random_walk>1e-6</random_walk><scale_error>0.03</scale_error><cross_axis>0.02</cross_axis>
          <bandwidth_Hz>98</bandwidth_Hz><range>17</range><resolution>0.001</resolution>
          <delay_s>0.002</delay_s><g_sensitivity>1e-4</g_sensitivity>
        </koboshi:gyro>
        <koboshi:accelerometer>
          <noise_density>2e-4</noise_density><bias>0.2</bias><bias_instability>2e-5</bias_instability>
          <random_walk>2e-6</random_walk><scale_error>0.04</scale_error><cross_axis>0.03</cross_axis>
          <bandwidth_Hz>97</bandwidth_Hz><range>39</range><resolution>0.002</resolution>
          <delay_s>0.002</delay_s>
        </koboshi:accelerometer>
      </sensor>
    </link>
    <joint name="ankle" type="revolute">
      <pose relative_to="foot">0 0 0.02 0 0 0</pose>
      <parent>base</parent>
      <child>foot</child>
      <axis>
        <xyz expressed_in="base">1 0 0</xyz>
        <limit><lower>-1</lower><upper>2</upper><velocity>7</velocity></limit>
      </axis>
      <koboshi:servo type="small" gear="1.5"/>
      <koboshi:encoder bits="14" offset_rad="0.01" noise_counts="0.2"/>
      <koboshi:drive node_id="17" vendor_id="5" product_code="6" serial_number="7" sign="-1" zero_rad="0.5"/>
      <koboshi:role>left_ankle_roll</koboshi:role>
      <koboshi:mirror>ankle</koboshi:mirror>
      <koboshi:maker servo_id="18" sign="-1" zero_ticks="512" ticks_per_turn="1228.8"/>
      <sensor name="left_ankle" type="force_torque">
        <pose>0 0 -0.01 0 0 0.1</pose>
        <update_rate>500</update_rate>
        <koboshi:jitter_s>0.0002</koboshi:jitter_s>
        <force_torque><frame>sensor</frame><measure_direction>child_to_parent</measure_direction></force_torque>
        <koboshi:force>
          <noise_density>3e-4</noise_density><bias>0.3</bias><bias_instability>3e-5</bias_instability>
          <random_walk>3e-6</random_walk><scale_error>0.05</scale_error><cross_axis>0.04</cross_axis>
          <bandwidth_Hz>96</bandwidth_Hz><range>60</range><resolution>0.003</resolution>
          <delay_s>0.002</delay_s>
        </koboshi:force>
        <koboshi:torque>
          <noise_density>4e-4</noise_density><bias>0.4</bias><bias_instability>4e-5</bias_instability>
          <random_walk>4e-6</random_walk><scale_error>0.06</scale_error><cross_axis>0.05</cross_axis>
          <bandwidth_Hz>95</bandwidth_Hz><range>4</range><resolution>0.004</resolution>
          <delay_s>0.002</delay_s>
        </koboshi:torque>
        <koboshi:crosstalk>0.07</koboshi:crosstalk>
      </sensor>
    </joint>
    <link name="toes">
      <pose relative_to="foot">0.02 0 0 0 0 0</pose>
      <inertial><mass>0.1</mass><inertia><ixx>2e-4</ixx><iyy>3e-4</iyy><izz>4e-4</izz></inertia></inertial>
    </link>
    <joint name="toe_joint" type="revolute">
      <parent>foot</parent>
      <child>toes</child>
      <axis>
        <xyz>0 1 0</xyz>
        <limit><lower>-1</lower><upper>1</upper><velocity>1</velocity></limit>
        <mimic joint="ankle"><multiplier>-0.5</multiplier><offset>0.1</offset><reference>0.2</reference></mimic>
      </axis>
    </joint>
  </model>
</sdf>
)";

}  // namespace koboshi::sim_board
