#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace koboshi::sim {

// The robot as its file describes it, in SI units and radians. Frames after REP-103: x forward, y left, z up.
// Poses are those of the robot at joint zero, in the model frame M, unless a comment says otherwise.

// Contact of a surface with another, as the file gives it: ODE's own parameters at a reference step.
struct SurfaceDescription {
  double friction = 0.8;         // Coulomb's mu, first direction
  double friction_second = 0.8;  // second direction
  double bounce = 0.0;           // coefficient of restitution, 0..1
  double bounce_threshold_m_per_s = 0.01;
  double error_reduction = 0.2;           // ERP at reference_step_s
  double constraint_force_mixing = 1e-5;  // CFM at reference_step_s, in ODE's unit (s^-1 kg^-1 times step)
  double reference_step_s = 0.001;
  double slip_m_per_N_s = 0.0;  // speed of sliding that a newton of friction at a contact point brings
  // The first direction of friction, of any length but zero, in the frame of the box or of the piece of
  // ground; a plane's is the world's. Without it, the ground's x axis.
  std::optional<Eigen::Vector3d> friction_direction;
  std::string material;  // by which pairs of materials know it (sim_board/world/surface_contact.h)
};

struct BoxDescription {
  std::string name;
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();  // geometry in its link's frame
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  SurfaceDescription surface;
};

// A triangle mesh for looks only.
struct MeshDescription {
  std::filesystem::path file;
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

struct LinkDescription {
  std::string name;
  Eigen::Isometry3d X_ML = Eigen::Isometry3d::Identity();
  double mass_kg = 0.0;
  int mass_line = 0;                                       // of the file; 0: not from a file
  Eigen::Vector3d p_LCom_L = Eigen::Vector3d::Zero();      // centre of mass in the link's frame
  Eigen::Matrix3d I_LCom_L = Eigen::Matrix3d::Identity();  // inertia about the CoM, axes of the link
  std::vector<BoxDescription> collisions;
  std::vector<BoxDescription> visual_boxes;
  std::vector<MeshDescription> meshes;
};

// What goes with the torque of the motor, and what with the torque that the robot puts on the output.
struct LoadShares {
  double motor = 0.0;
  double external = 0.0;
};

struct StribeckDescription {
  double friction_Nm = 0.0;      // Kcs
  double speed_rad_per_s = 1.0;  // ws: where the effect has fallen to 1/e
  double exponent = 1.0;         // a
};

// The copper of a motor, one thermal node between its losses and the air.
struct WindingDescription {
  double thermal_resistance_K_per_W = 0.0;  // to the air
  double heat_capacity_J_per_K = 0.0;
  double ambient_C = 25.0;     // of the air, and of the winding at the start; resistance_ohm is meant there
  double derating_C = 80.0;    // from here on the drive gives less voltage,
  double shutdown_C = 100.0;   // down to derated_share here, where it goes to fault
  double derated_share = 0.5;  // 0..1
  double copper_per_K = 0.00393;  // rise of the resistance
};

// How targets reach the position loop, and positions the bus.
struct CommandDescription {
  int period_ms = 1;       // the servo looks for a new target once in this time
  int write_delay_ms = 0;  // a target takes effect so much later
  int read_delay_ms = 0;   // the position on the bus is so old
  double dead_band_rad = 0.0;
};

// A slow quantity of one value, as a supply's voltage or a motor's temperature; ScalarSensor measures it.
struct ScalarSensorDescription {
  double noise = 0.0;        // standard deviation of a sample, unit
  double offset = 0.0;       // largest magnitude of the constant offset, unit; drawn by seed within it
  double scale_error = 0.0;  // largest error of the scale, as a share; drawn by seed within it
  double lowest = 0.0;       // what it can show, unit
  double highest = 0.0;
  double resolution = 0.0;  // unit a count
  double sample_period_s = 0.01;
};

// A DC motor with gearbox seen at the output shaft, and the position controller of its drive. What follows
// the velocity gain has no effect with the values here. Equations: docs/reference/servo.md.
struct ServoDescription {
  double torque_constant_Nm_per_A = 1.0027;  // kt, output side
  double resistance_ohm = 5.477;             // R
  double supply_V = 7.5;                     // nominal; what there is where the robot has no battery
  double rotor_inertia_kg_m2 = 0.00116;      // J, output side
  double coulomb_friction_Nm = 0.0275;       // Kc
  double viscous_friction_Nm_s = 0.0033;     // Kv
  double full_voltage_error_rad = 0.122;   // position error at which the controller applies the whole supply
  double velocity_gain_V_s_per_rad = 0.0;  // additional damping of the controller, on the encoder's speed
  double max_duty = 1.0;                   // largest part of the supply that the bridge can give
  double current_limit_A = std::numeric_limits<double>::infinity();
  StribeckDescription stribeck = {};
  LoadShares load_friction = {};                   // Km, Ke; equal in model M4
  LoadShares stribeck_load_friction = {};          // Kms, Kes
  LoadShares quadratic_load_friction_per_Nm = {};  // Kmq, Keq
  double backlash_rad = 0.0;                       // of the output against the rotor, from edge to edge
  std::optional<WindingDescription> winding = {};  // none: stays at its resistance, however hot
  CommandDescription command = {};
  // Of the drive's own; none: it knows the values themselves.
  std::optional<ScalarSensorDescription> voltmeter = {};    // V
  std::optional<ScalarSensorDescription> thermometer = {};  // C, of the winding
};

// What all servos hang on: a voltage behind a resistance (cells, switch and wires).
struct BatteryDescription {
  double open_circuit_V = 0.0;
  double internal_resistance_ohm = 0.0;
};

struct EncoderDescription {
  int bits = 12;              // counts a turn = 2^bits
  double offset_rad = 0.0;    // mounting error of this encoder
  double noise_counts = 0.0;  // standard deviation
};

// The CANopen node of a joint's drive.
struct DriveDescription {
  std::uint8_t node_id = 0;              // 16..35 on the default robot
  std::uint32_t vendor_id = 0x4B4F4249;  // object 0x1018; no number that CiA has given to anybody
  std::uint32_t product_code = 1;
  std::uint32_t serial_number = 0;
  int sign = 1;  // shaft turns by sign * joint angle + zero
  double zero_rad = 0.0;
};

// Every joint is a hinge.
struct JointDescription {
  std::string name;
  int parent = -1;                                 // index of a link
  int child = -1;                                  // index of a link
  Eigen::Vector3d p_MJ = Eigen::Vector3d::Zero();  // anchor at joint zero
  Eigen::Vector3d axis_M =
      Eigen::Vector3d::UnitZ();  // unit vector at joint zero; positive by the right-hand rule
  double lower_rad = 0.0;
  double upper_rad = 0.0;
  double max_speed_rad_per_s = 0.0;
  ServoDescription servo;
  EncoderDescription encoder;
  DriveDescription drive;
};

// Errors and dynamics of one sampled axis group; each is a class of its own in sim_board/sensor, and
// docs/reference/sensors.md tells how they act together.
struct ChannelDescription {
  double noise_density = 0.0;     // one-sided, unit / sqrt(Hz)
  double bias = 0.0;              // largest magnitude of the constant bias, unit; drawn by seed within it
  double bias_instability = 0.0;  // B of IEEE Std 952, unit
  double random_walk = 0.0;       // K of IEEE Std 952, unit / sqrt(s)
  double scale_error = 0.0;       // largest error of an axis' scale, as a share; drawn by seed within it
  double cross_axis = 0.0;        // largest share of an axis that another one shows; drawn by seed within it
  double bandwidth_Hz = 98.0;     // of the 2nd-order anti-alias filter
  double range = 0.0;             // saturates at +-range, unit
  double resolution = 0.0;        // unit a count
  double sample_period_s = 0.001;
  double jitter_s = 0.0;  // largest deviation of a sampling instant; less than half the sampling period
  double delay_s = 0.001;
};

struct ImuDescription {
  std::string name;
  int link = -1;
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
  ChannelDescription gyro;           // rad/s
  ChannelDescription accelerometer;  // m/s^2
  double g_sensitivity = 0.0;  // largest rate that a gyro's axis shows of an acceleration's, rad/s per m/s^2
};

// Six-axis sensor between shank side and ground side, measuring what crosses `joint` and below; frame S at
// the sensor.
struct AnkleSensorDescription {
  std::string name;
  int joint = -1;                                          // the hinge whose child is the foot
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();  // in the foot link's frame
  double height_above_sole_m = 0.0;                        // d of the paper's equation 1
  ChannelDescription force;                                // N
  ChannelDescription torque;                               // N m
  double crosstalk =
      0.0;  // largest share of its range that a force shows of a torque at its range, or reverse
};

// A joint, and the factor (1 or -1) that makes its angle the mirror image of the left one's.
struct MirroredJoint {
  int joint = 0;
  int sign = 1;
};

struct RobotDescription {
  std::string name;
  std::filesystem::path file;
  std::vector<LinkDescription> links;         // links[0] is the base (trunk)
  std::vector<JointDescription> joints;       // in the order of node ids; parents may come in any order
  std::optional<BatteryDescription> battery;  // none: each servo has a supply of its own
  std::optional<ImuDescription> imu;
  std::optional<AnkleSensorDescription> left_ankle;
  std::optional<AnkleSensorDescription> right_ankle;

  double total_mass_kg() const;
  // Index of the joint or link with this name, or nothing.
  std::optional<int> find_joint(const std::string& joint_name) const;
  std::optional<int> find_link(const std::string& link_name) const;
  // The joints that files for people mean by a name: the joint itself, or left_ and right_ with this name, of
  // which the right one mirrors the left; empty where there is none.
  std::vector<MirroredJoint> find_joints(const std::string& joint_name) const;
};

// A rotation by q about the axis, seen in a mirror on the plane y = 0, is one by q about the result.
Eigen::Vector3d mirrored_axis(const Eigen::Vector3d& axis);

}  // namespace koboshi::sim
