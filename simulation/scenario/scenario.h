#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "hal/port/ankle.h"
#include "sim_board/can/babbler.h"
#include "sim_board/can/bus_faults.h"
#include "sim_board/description/description.h"
#include "sim_board/world/options.h"
#include "simulation/disturbance/world_ranges.h"

namespace koboshi::simulation {

// Contents of a scenario file. SI units and radians; docs/reference/scenario-format.md gives the units of the
// file.

// A name of a part of the robot, with its source for error messages.
struct SourcedName {
  std::string text;
  std::filesystem::path source;
  int line = 0;
};

struct MotionChoice {
  std::filesystem::path file;
  std::vector<Override> overrides{};  // applied to the motion file

  std::string name() const { return file.stem().string(); }
};

// A walk that is generated for the robot from a gait file (docs/reference/gait-format.md). It becomes the
// motion `walk`, after all others.
struct GaitChoice {
  std::filesystem::path file;
  std::vector<Override> overrides;  // applied to the gait file
  bool feedback = true;             // sets the gait's gyro feedback gains in the controller
};
inline constexpr const char* kGaitMotion = "walk";

struct InitialJoint {
  SourcedName joint;
  double position_rad = 0.0;
};

// The robot's initial state, at rest.
struct InitialState {
  std::optional<double>
      base_height_m;    // of the base link's origin; if empty, the lowest point touches the ground
  double drop_m = 0.0;  // height above ground contact if base_height_m is empty
  Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();  // attitude of the base link
  bool fixed_base = false;                             // the base link is fixed to a stand
  std::optional<std::uint64_t> release_us;             // time of release from the stand; empty: never
  std::vector<InitialJoint> joints;  // all others are zero; if empty, the standing pose of the gait
};

// Properties of the ground or a piece of it. Missing values are inherited from the plane, and those of the
// plane from a hard floor.
struct GroundSurface {
  struct Softness {
    double stiffness_N_per_m = 0.0;  // per contact point; a sole has four
    double damping_N_s_per_m = 0.0;
  };

  std::string material;                          // empty: inherited
  std::optional<double> friction;                // Coulomb's mu; a lower value in the robot file prevails
  std::optional<double> friction_second;         // across the first direction; if empty, as along it
  std::optional<double> friction_direction_rad;  // from the piece's x axis, about its z axis
  std::optional<Softness> softness;
  std::optional<double> bounce;  // coefficient of restitution
  std::optional<double> bounce_threshold_m_per_s;
  std::optional<double> slip_m_per_N_s;
};

// A randomly generated height field: waves of one wavelength from all directions, decaying to zero at the
// rim.
struct RoughGround {
  Eigen::Isometry3d X_WF = Eigen::Isometry3d::Identity();
  Eigen::Vector2d size_m = Eigen::Vector2d::Ones();
  double spacing_m = 0.01;  // approximate grid spacing
  double height_m = 0.01;   // from the lowest to the highest point, without the rim
  double wavelength_m = 0.05;
  std::optional<std::uint64_t> seed;  // if empty, the scenario's
};

// A piece of ground on the plane. Its pose is in the plane's frame, which has the world's origin and z along
// the normal.
struct GroundShape {
  std::variant<sim_board::FrictionPatch, sim_board::GroundBox, sim_board::HeightField, RoughGround> shape;
  GroundSurface surface;
};

struct Ground : GroundSurface {
  double roll_rad = 0.0;  // rotation of the plane about x, then about y
  double pitch_rad = 0.0;
  std::vector<GroundShape> shapes;
};

// Contact properties of a pair of materials, with the source for error messages.
struct NamedMaterialPair {
  std::array<SourcedName, 2> names;
  sim_board::MaterialPair pair;
};

// A ball or box beside the robot, at rest or moving.
struct FreeBody {
  sim_board::FreeBodyDescription body;  // the pose without a height that the file leaves out
  bool on_ground = false;               // its height is that at which it lies on the ground
  SourcedName name;
};

struct Physics {
  std::uint64_t step_us = 1000;  // divides 1 ms
  sim_board::Stepper stepper = sim_board::Stepper::kLumped;
  sim_board::FrictionMethod friction = sim_board::FrictionMethod::kLockAndCheck;
};

// A controller parameter in the unit that its name ends with. The firmware's dictionary defines the valid
// names.
struct ParameterSetting {
  SourcedName name;
  double value = 0.0;
};

// A joint of a stream of joint targets.
struct StreamedJoint {
  SourcedName joint;
  double target_rad = 0.0;
};

// An operator's command to the controller.
struct Command {
  enum class Kind { kEnable, kPlay, kWalk, kStop, kGetUp, kEmergencyStop, kReset, kStream };

  std::uint64_t at_us = 0;
  Kind kind = Kind::kEnable;
  std::size_t motion = 0;  // for kPlay: index into Scenario::motions
  // For kWalk: m/s forward and to the left, rad/s counter-clockwise.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  // For kStream: the operator repeats these targets until its next command; the other joints stay. Empty: it
  // only begins the stream, whose sets somebody else sends.
  std::vector<StreamedJoint> stream{};
};

// A set of the joint target stream (docs/decision/0041).
struct StreamSet {
  std::vector<double> targets_rad;            // by joint
  std::vector<double> torque_limits_percent;  // likewise, 1 to 100; empty: as they are
};

// A force on a link during an interval.
struct Push {
  enum class Shape { kRectangle, kHalfSine };

  std::uint64_t at_us = 0;
  std::uint64_t duration_us = 0;
  SourcedName link;
  Shape shape = Shape::kRectangle;
  Eigen::Vector3d force_W_N = Eigen::Vector3d::Zero();  // peak value in world axes
  std::optional<Eigen::Vector3d> p_L_m;                 // in the link's frame; empty: the centre of mass

  // Mean force over the non-empty interval [start_us, end_us): the impulse does not depend on the physics
  // step.
  Eigen::Vector3d mean_force_W_N(std::uint64_t start_us, std::uint64_t end_us) const;
};

// A fault, temporary or for the rest of the run.
struct Fault {
  enum class Kind {
    kDriveSilent,        // a drive neither receives nor sends; its motor keeps its state
    kDrivePowerLoss,     // a drive and its motor lose power
    kEncoderBreak,       // a drive loses its encoder
    kDriveOverheat,      // a motor's winding overheats
    kSupplyDrop,         // the supply voltage of all servos is limited
    kBatteryDischarge,   // the battery's open-circuit voltage falls and stays low
    kImuStop,            // the IMU delivers no samples
    kAnkleStop,          // an ankle sensor delivers no samples
    kControllerStop,     // the firmware stops; the board continues
    kBusUnacknowledged,  // no node acknowledges the controller's frames
    kBusDominant,        // a short circuit blocks the bus
    kFramesLost,         // receivers drop acknowledged frames
    kFramesCorrupted,    // bit errors on the wire
    kFramesDelayed,      // delayed delivery to receivers
    kFramesDoubled,      // duplicate delivery to receivers
    kBabblingNode,       // an additional node floods the bus
  };
  // Names of the kinds in scenario files, in the order of the enumeration.
  static const std::vector<std::string>& kind_names();

  std::uint64_t at_us = 0;
  std::optional<std::uint64_t> duration_us;  // empty: for the rest of the run
  Kind kind = Kind::kControllerStop;
  // For drive faults, the joint. For frame faults, the affected node: a joint, kControllerTarget, or empty
  // for all. For all others, only the source location.
  SourcedName target;
  hal::Side side = hal::Side::kLeft;  // for kAnkleStop
  double highest_V = 0.0;             // for kSupplyDrop
  double open_circuit_V = 0.0;        // for kBatteryDischarge, `over_us` after at_us
  std::uint64_t over_us = 0;          // for kBatteryDischarge
  sim_board::FrameFault frames;       // for frame faults; node and times are those above
  sim_board::Babble babble;           // for kBabblingNode; times as above

  std::uint64_t end_us() const {
    return duration_us ? at_us + *duration_us : std::numeric_limits<std::uint64_t>::max();
  }
};
inline constexpr const char* kControllerTarget = "controller";

// Factory parameters of the robot's controller: robots/ROBOT/parameters.yaml. No duplicate names.
struct RobotParameters {
  std::filesystem::path file;  // empty: the robot has none
  SourcedName robot;           // the robot for which they were tuned
  std::vector<ParameterSetting> settings;
};

// A value of the simulated robot that differs from the robot's file, and so from the firmware's model.
struct PlantSetting {
  SourcedName field;  // as in `koboshi model set`: left_shank.mass
  std::string value;  // with or without a unit: 80 g
};

// A world that differs from the files by a random draw.
struct WorldChoice {
  WorldRanges ranges;
  std::optional<std::uint64_t> seed;  // of the draw; if empty, the run's
};

struct Scenario {
  std::filesystem::path file;
  YamlNode document{};  // contents of the file including the overrides; null if there is no file
  std::filesystem::path robot;
  RobotParameters robot_parameters;
  std::vector<PlantSetting> plant;    // in the order in which they are set
  std::optional<WorldChoice> world;   // empty: as the files describe it
  std::vector<MotionChoice> motions;  // the index is the motion's number in the controller
  // Motions of the key `motions` with a purpose, such as `rise_prone`, that the robot does not have.
  std::vector<std::string> missing_motions{};
  // Value of the key `parameter_file` if it is `standing` and the robot has no such file; else empty.
  std::string missing_parameter_file{};
  std::optional<GaitChoice> gait;
  std::uint64_t duration_us = 0;
  std::uint64_t seed = 1;
  double noise_scale = 1.0;               // scales the sensors' random errors
  std::uint64_t computing_time_us = 500;  // of the controller per tick
  std::uint64_t tick_jitter_us = 0;       // largest delay of a tick
  bool teleop = false;                    // an operator controls the run
  Physics physics;
  Ground ground;
  std::vector<NamedMaterialPair> materials;
  std::vector<FreeBody> bodies;
  InitialState initial;
  std::optional<std::filesystem::path> policy{};  // the image of a policy, for the factory's catalogue
  std::optional<std::filesystem::path> parameter_file;
  // The parameters of that file, then the scenario's own, written in this order before the first command. No
  // duplicate names.
  std::vector<ParameterSetting> parameters;
  // Each list is in order of time, and in file order for equal times.
  std::vector<Command> commands;
  std::vector<Push> pushes;
  std::vector<Fault> faults;
};

// Returns the files that determine the scenario's result: itself and all that it refers to.
std::vector<std::filesystem::path> input_files(const Scenario& scenario);

// Throws InputError at the first error: a name that the robot does not have, a material that neither robot
// nor ground uses, an initial joint position beyond the joint's limits, or parameters of another robot.
void check(const Scenario& scenario, const sim_board::RobotDescription& robot);
// Checks the joints of a command.
void check(const Command& command, const sim_board::RobotDescription& robot);
// Checks a single push.
void check(const Push& push, const sim_board::RobotDescription& robot);
// Checks a single fault.
void check(const Fault& fault, const sim_board::RobotDescription& robot);
// Checks that the parameters are those of the robot.
void check(const RobotParameters& parameters, const sim_board::RobotDescription& robot);
// Returns the names of the motions for commands, in the order of the controller's numbers; a gait comes last.
std::vector<std::string> motion_names(const Scenario& scenario);
// Returns one line that names what the scenario would take from the folder of its robot and left out because
// the robot does not have it, and the command that makes it. Empty if nothing is left out.
std::string left_out_text(const Scenario& scenario);

}  // namespace koboshi::simulation
