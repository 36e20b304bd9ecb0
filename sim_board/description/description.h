#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "hal/port/ankle.h"
#include "hal/port/side.h"

namespace koboshi::sim_board {

// A robot as described in its file, in SI units and radians. Frames follow REP-103: x forward, y left, z up.
// Poses are those of the robot at joint angles zero, in the model frame M, unless a comment says otherwise.

// Contact properties of a surface as given in the file: ODE's own parameters at a reference step.
struct SurfaceDescription {
  double friction = 0.8;         // Coulomb's mu, first direction
  double friction_second = 0.8;  // second direction
  double bounce = 0.0;           // coefficient of restitution, 0..1
  double bounce_threshold_m_per_s = 0.01;
  double error_reduction = 0.2;           // ERP at reference_step_s
  double constraint_force_mixing = 1e-5;  // CFM at reference_step_s, in ODE's unit (s^-1 kg^-1 times step)
  double reference_step_s = 0.001;
  double slip_m_per_N_s = 0.0;  // sliding speed per newton of friction at a contact point
  // First direction of friction, of any non-zero length, in the frame of the box or of the piece of ground;
  // for a plane, the world frame. Default: the ground's x axis.
  std::optional<Eigen::Vector3d> friction_direction;
  std::string material;  // name by which material pairs refer to it (sim_board/world/surface_contact.h)
};

// Colour of a visual: red, green and blue, each 0..1, sRGB.
using ColourDescription = std::array<float, 3>;

struct BoxDescription {
  std::string name;
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();  // pose of the geometry in its link's frame
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  SurfaceDescription surface;
  std::optional<ColourDescription> colour;  // visuals only; without it, the viewer chooses
};

// A triangle mesh for rendering only: its vertices, times `scale`, are in frame G.
struct MeshDescription {
  std::string name;
  std::filesystem::path file;
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  std::optional<ColourDescription> colour;  // without it, the viewer chooses
};

struct LinkDescription {
  std::string name;
  int line = 0;  // in the file; 0: not from a file
  Eigen::Isometry3d X_ML = Eigen::Isometry3d::Identity();
  double mass_kg = 0.0;
  int mass_line = 0;                                       // as `line`
  Eigen::Vector3d p_LCom_L = Eigen::Vector3d::Zero();      // centre of mass in the link's frame
  Eigen::Matrix3d I_LCom_L = Eigen::Matrix3d::Identity();  // inertia about the CoM, axes of the link
  std::vector<BoxDescription> collisions;
  std::vector<BoxDescription> visual_boxes;
  std::vector<MeshDescription> meshes;
};

// Coefficients of the motor's torque and of the external torque on the output.
struct LoadShares {
  double motor = 0.0;
  double external = 0.0;
};

struct StribeckDescription {
  double friction_Nm = 0.0;      // Kcs
  double speed_rad_per_s = 1.0;  // ws: speed at which the effect has decreased to 1/e
  double exponent = 1.0;         // a
};

// Thermal model of the motor's winding: one node between its losses and the air.
struct WindingDescription {
  double thermal_resistance_K_per_W = 0.0;  // to the air
  double heat_capacity_J_per_K = 0.0;
  double ambient_C = 25.0;        // temperature of the air and initial temperature of the winding;
                                  // resistance_ohm applies at it
  double derating_C = 80.0;       // above it the drive reduces its voltage,
  double shutdown_C = 100.0;      // to derated_share here, where the drive enters fault
  double derated_share = 0.5;     // 0..1
  double copper_per_K = 0.00393;  // temperature coefficient of the resistance
};

// Timing of targets to the position loop and of positions to the bus.
struct CommandDescription {
  int period_ms = 1;       // period at which the servo reads a new target
  int write_delay_ms = 0;  // delay until a target takes effect
  int read_delay_ms = 0;   // age of the position on the bus
  double dead_band_rad = 0.0;
};

// Sensor of a slow scalar quantity, such as a supply voltage or a motor's temperature. ScalarSensor
// implements it.
struct ScalarSensorDescription {
  double noise = 0.0;        // standard deviation of a sample, unit
  double offset = 0.0;       // bound of the constant offset, unit; drawn by seed within it
  double scale_error = 0.0;  // bound of the relative scale error; drawn by seed within it
  double lowest = 0.0;       // lower end of the range, unit
  double highest = 0.0;
  double resolution = 0.0;  // unit per count
  double sample_period_s = 0.01;
};

// A DC motor with gearbox, expressed at the output shaft, and the position controller of its drive. The
// members after velocity_gain are inactive at these defaults. Equations: docs/reference/servo.md.
struct ServoDescription {
  double torque_constant_Nm_per_A = 1.0027;  // kt, output side
  double resistance_ohm = 5.477;             // R
  double supply_V = 7.5;                     // nominal; actual if the robot has no battery
  double rotor_inertia_kg_m2 = 0.00116;      // J, output side
  double coulomb_friction_Nm = 0.0275;       // Kc
  double viscous_friction_Nm_s = 0.0033;     // Kv
  double full_voltage_error_rad = 0.122;     // position error at which the controller applies the full supply
  double velocity_gain_V_s_per_rad = 0.0;    // additional damping of the controller, acting on the encoder's
                                             // speed
  double max_duty = 1.0;                     // maximum duty cycle of the bridge
  double current_limit_A = std::numeric_limits<double>::infinity();
  StribeckDescription stribeck = {};
  LoadShares load_friction = {};                   // Km, Ke; equal in model M4
  LoadShares stribeck_load_friction = {};          // Kms, Kes
  LoadShares quadratic_load_friction_per_Nm = {};  // Kmq, Keq
  double backlash_rad = 0.0;                       // between output and rotor, from edge to edge
  std::optional<WindingDescription> winding = {};  // without it, the resistance does not depend on the
                                                   // temperature
  CommandDescription command = {};
  // Sensors of the drive; without one, the drive knows the exact value.
  std::optional<ScalarSensorDescription> voltmeter = {};    // V
  std::optional<ScalarSensorDescription> thermometer = {};  // C, of the winding
};

// Common supply of all servos: a voltage source behind a resistance (cells, switch and wires).
struct BatteryDescription {
  double open_circuit_V = 0.0;
  double internal_resistance_ohm = 0.0;
};

struct EncoderDescription {
  int bits = 12;              // counts per turn = 2^bits
  double offset_rad = 0.0;    // mounting error of the encoder
  double noise_counts = 0.0;  // standard deviation
};

// CANopen node of a joint's drive.
struct DriveDescription {
  std::uint8_t node_id = 0;              // 16..35 on the default robot
  std::uint32_t vendor_id = 0x4B4F4249;  // object 0x1018; not assigned to any vendor by CiA
  std::uint32_t product_code = 1;
  std::uint32_t serial_number = 0;
  int sign = 1;  // shaft angle = sign * joint angle + zero
  double zero_rad = 0.0;
};

// A joint in the maker's own software: the servo's number, direction and zero in motion files.
struct MakerDescription {
  int servo_id = 0;
  int sign = 1;                // ticks = zero + sign * joint angle * ticks_per_turn / 2 pi
  double zero_ticks = 2048.0;  // at joint angle zero
  double ticks_per_turn = 4096.0;
};

// Every joint is a hinge.
struct JointDescription {
  std::string name;
  int line = 0;                                       // in the file; 0: not from a file
  int parent = -1;                                    // index of a link
  int child = -1;                                     // index of a link
  Eigen::Vector3d p_MJ = Eigen::Vector3d::Zero();     // anchor at joint zero
  Eigen::Vector3d axis_M = Eigen::Vector3d::UnitZ();  // unit vector at joint zero; right-handed
  double lower_rad = 0.0;
  double upper_rad = 0.0;
  double max_speed_rad_per_s = 0.0;
  double gear = 1.0;       // turns of the servo's output shaft per turn of the joint
  ServoDescription servo;  // behind the gear, as the joint sees it
  EncoderDescription encoder;
  DriveDescription drive;
  std::string stated_role = {};    // empty: the name is the role
  std::string stated_mirror = {};  // name of a joint; empty: the joint with the role of the other side
  std::optional<MakerDescription> maker = {};

  // The joint's place in a humanoid, such as left_hip_pitch (roles.h).
  const std::string& role() const { return stated_role.empty() ? name : stated_role; }
};

// A hinge that the motor of another joint turns as well, such as the second hip yaw of a robot with one motor
// for both (SDF 1.11, <mimic>). It has no servo, no encoder and no drive of its own.
struct FollowerDescription {
  JointDescription hinge;  // servo, encoder and drive are not used
  int leader = -1;         // index of the joint whose motor turns it
  double multiplier = 1.0;
  double offset_rad = 0.0;

  double position_rad(double leader_rad) const { return multiplier * leader_rad + offset_rad; }
};

// Errors and dynamics of one sampled group of axes. Each has its own class in sim_board/sensor;
// docs/reference/sensors.md describes how they combine.
struct ChannelDescription {
  double noise_density = 0.0;     // one-sided, unit / sqrt(Hz)
  double bias = 0.0;              // bound of the constant bias, unit; drawn by seed within it
  double bias_instability = 0.0;  // B of IEEE Std 952, unit
  double random_walk = 0.0;       // K of IEEE Std 952, unit / sqrt(s)
  double scale_error = 0.0;       // bound of an axis' relative scale error; drawn by seed within it
  double cross_axis = 0.0;        // bound of the cross-axis sensitivity; drawn by seed within it
  double bandwidth_Hz = 98.0;     // of the 2nd-order anti-alias filter
  double range = 0.0;             // saturates at +-range, unit
  double resolution = 0.0;        // unit per count
  double sample_period_s = 0.001;
  double jitter_s = 0.0;  // bound of the sampling jitter; less than half the sampling period
  double delay_s = 0.001;
};

struct ImuDescription {
  std::string name;
  int line = 0;  // in the file; 0: not from a file
  int link = -1;
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
  ChannelDescription gyro;           // rad/s
  ChannelDescription accelerometer;  // m/s^2
  double g_sensitivity = 0.0;        // bound of a gyro axis' g-sensitivity, rad/s per m/s^2
};

// Sensor of a foot; frame S is at the sensor. Six axes, between shank side and ground side, measure the
// wrench across `joint` and below. Pressure cells and a contact switch are in the sole.
struct AnkleSensorDescription {
  hal::AnkleKind kind = hal::AnkleKind::kSixAxis;  // not kNone
  std::string name;
  int line = 0;                                                  // in the file; 0: not from a file
  int joint = -1;                                                // the hinge whose child is the foot
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();        // in the foot link's frame
  double height_above_sole_m = 0.0;                              // d of the paper's equation 1
  ChannelDescription force;                                      // N; of a cell; of a switch, its contact
  ChannelDescription torque;                                     // N m; of six axes only
  std::array<Eigen::Vector2d, hal::kPressureCells> cells_S_m{};  // of pressure cells
  double closing_force_N = 0.0;                                  // of a switch; it opens at half of it
  double crosstalk = 0.0;  // bound of the crosstalk from torque to force and back, as a share of the ranges
};

// A joint, and the sign (1 or -1) that maps the left joint's angle to its mirror image.
struct MirroredJoint {
  int joint = 0;
  int sign = 1;
};

struct RobotDescription {
  std::string name;
  std::filesystem::path file;
  int line = 0;                                  // of the model in the file; 0: not from a file
  std::vector<LinkDescription> links;            // links[0] is the base (trunk)
  std::vector<JointDescription> joints;          // in the order of node ids; parents may be in any order
  std::vector<FollowerDescription> followers{};  // hinges without a motor of their own
  std::optional<BatteryDescription> battery;     // without it, each servo has its own supply
  std::optional<ImuDescription> imu;
  std::optional<AnkleSensorDescription> left_ankle;
  std::optional<AnkleSensorDescription> right_ankle;

  double total_mass_kg() const;
  // All hinges: the joints, then the followers.
  std::size_t hinge_count() const { return joints.size() + followers.size(); }
  const JointDescription& hinge(std::size_t index) const {
    return index < joints.size() ? joints[index] : followers.at(index - joints.size()).hinge;
  }
  // Returns the positions of all hinges for those of the joints.
  std::vector<double> hinge_positions_rad(std::vector<double> positions_rad) const;
  // Returns the follower that is the joint's counterpart on the other side and follows it; or null.
  const FollowerDescription* mirrored_follower(int joint) const;
  // Names in the order of `joints` and `links`.
  std::vector<std::string> joint_names() const;
  std::vector<std::string> link_names() const;
  // Returns the index of the joint with this name, otherwise of the one with this role, or nothing.
  std::optional<int> find_joint(const std::string& name_or_role) const;
  // Returns the joint of the other side; the joint itself if it is in the middle or alone.
  int mirror_of(int joint) const;
  // Returns the joint that carries the foot: the last one of the leg's joints (roles from hip_yaw to
  // ankle_roll), from the base down. Nothing if the robot has no such leg.
  std::optional<int> foot_joint(hal::Side side) const;
  // Returns the kind of the sensors in the feet.
  hal::AnkleKind ankle_kind() const { return left_ankle ? left_ankle->kind : hal::AnkleKind::kNone; }
  // Returns the index of the link with this name, or nothing.
  std::optional<int> find_link(const std::string& link_name) const;
  // Returns the joints that a name in a user's file refers to: the joint itself, or those whose names or
  // roles are left_ and right_ plus this name, where the right one mirrors the left. Empty if there is none.
  std::vector<MirroredJoint> find_joints(const std::string& joint_name) const;
};

// Returns the robot for a physics engine: each follower is a joint, behind all others, whose range is that
// which its leader's stops leave it. The followers' numbers in `joints` follow from their order.
RobotDescription with_followers_as_joints(RobotDescription robot);

// Returns the axis about which the mirror image (in the plane y = 0) of a rotation by q about `axis` is again
// a rotation by q.
Eigen::Vector3d mirrored_axis(const Eigen::Vector3d& axis);

}  // namespace koboshi::sim_board
