#pragma once

#include <string>

namespace koboshi::sim_board {

// The elements that a servo type must have.
inline const std::string kServoNumbers = R"(      <torque_constant_Nm_per_A>1</torque_constant_Nm_per_A>
      <resistance_ohm>5</resistance_ohm>
      <supply_V>7.5</supply_V>
      <rotor_inertia_kg_m2>0.001</rotor_inertia_kg_m2>
      <coulomb_friction_Nm>0.02</coulomb_friction_Nm>
      <viscous_friction_Nm_s>0.003</viscous_friction_Nm_s>
      <full_voltage_error_rad>0.1</full_voltage_error_rad>
)";

// Its optional effects but for the meters of voltage and temperature.
inline const std::string kServoEffects = R"(      <max_duty>0.9</max_duty>
      <current_limit_A>1.5</current_limit_A>
      <stribeck friction_Nm="0.02" speed_rad_per_s="2" exponent="1.7"/>
      <load_friction motor="0.1" external="0.2"/>
      <stribeck_load_friction motor="0.3" external="0.4"/>
      <quadratic_load_friction motor_per_Nm="0.01" external_per_Nm="0.02"/>
      <backlash_rad>0.01</backlash_rad>
      <winding thermal_resistance_K_per_W="10" heat_capacity_J_per_K="5" ambient_C="20" derating_C="70"
               shutdown_C="90" derated_share="0.3" copper_per_K="0.004"/>
      <command period_ms="10" write_delay_ms="2" read_delay_ms="3" dead_band_rad="0.004"/>
)";

// Two links and a hinge, with frames that take some turning.
inline const std::string kSmallRobot = R"(<sdf version="1.9" xmlns:koboshi="https://koboshi.invalid/sdf">
  <model name="arm">
    <koboshi:servo_type name="small">
)" + kServoNumbers + R"(    </koboshi:servo_type>
    <link name="hand">
      <pose relative_to="base">0 0 0.1 0 0 1.5707963267948966</pose>
      <inertial>
        <pose>0 0 0.05 0 0 0</pose>
        <mass>0.1</mass>
        <inertia><ixx>2e-4</ixx><iyy>3e-4</iyy><izz>4e-4</izz></inertia>
      </inertial>
      <collision name="box">
        <pose>0 0 0.05 0 0 0</pose>
        <geometry><box><size>0.02 0.03 0.1</size></box></geometry>
        <surface>
          <friction><ode><mu>0.7</mu><fdir1>0 1 0</fdir1></ode></friction>
          <bounce><restitution_coefficient>0.3</restitution_coefficient><threshold>0.05</threshold></bounce>
          <contact><ode><soft_cfm>2e-5</soft_cfm><soft_erp>0.4</soft_erp></ode></contact>
          <koboshi:reference_step_s>0.002</koboshi:reference_step_s>
          <koboshi:material>rubber</koboshi:material>
        </surface>
      </collision>
    </link>
    <link name="base">
      <pose>1 2 3 0 0 0</pose>
      <inertial>
        <mass>0.2</mass>
        <inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia>
      </inertial>
    </link>
    <joint name="wrist" type="revolute">
      <parent>base</parent>
      <child>hand</child>
      <axis>
        <xyz>1 0 0</xyz>
        <limit><lower>-1</lower><upper>2</upper><velocity>7</velocity></limit>
      </axis>
      <koboshi:servo type="small"/>
      <koboshi:encoder bits="14" offset_rad="0.01"/>
      <koboshi:drive node_id="17" serial_number="4294967295" sign="-1" zero_rad="0.5"/>
    </joint>
  </model>
</sdf>
)";

// `text` with `to` in the place of `from`, which must be there.
std::string replaced(std::string text, const std::string& from, const std::string& to);

// kSmallRobot with `to` in the place of `from`.
std::string with(const std::string& from, const std::string& to);

// Returns the complaint of loading `text`, with the file's name as FILE; "nothing" if there is none.
std::string complaint(const std::string& text);

}  // namespace koboshi::sim_board
