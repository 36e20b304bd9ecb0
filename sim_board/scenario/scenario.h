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

#include "hal/port/ankle.h"
#include "sim_board/can/babbler.h"
#include "sim_board/can/bus_faults.h"
#include "sim_board/input/yaml_tree.h"
#include "sim_board/robot/description.h"
#include "sim_board/world/options.h"

namespace koboshi::sim {

// What is done to a robot in one run. SI units and radians; the file's own units are in
// docs/reference/scenario-format.md.

// A name of something in the robot, and where it stands, so that an error can say so.
struct SourcedName {
  std::string text;
  std::filesystem::path source;
  int line = 0;
};

struct MotionChoice {
  std::filesystem::path file;
  std::vector<Override> overrides{};  // of the file's values

  std::string name() const { return file.stem().string(); }
};

// A walk, generated for the robot from a gait file (docs/reference/gait-format.md) as the motion `walk`,
// behind all others.
struct GaitChoice {
  std::filesystem::path file;
  std::vector<Override> overrides;  // of the file's values
  bool feedback = true;             // its gains of the gyro feedback are set in the controller
};
inline constexpr const char* kGaitMotion = "walk";

struct InitialJoint {
  SourcedName joint;
  double position_rad = 0.0;
};

// The robot before the first step, at rest.
struct InitialState {
  std::optional<double>
      base_height_m;    // of the base link's origin; without it the lowest point touches the ground
  double drop_m = 0.0;  // how far above touching the ground, without a base height
  Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();  // how the base link lies or stands
  bool fixed_base = false;                             // the base link hangs on a stand
  std::optional<std::uint64_t> release_us;             // when the stand lets go of it; without it, never
  std::vector<InitialJoint> joints;  // all others are at zero; without any, the stand of the gait
};

// What the ground or a piece of it is like. What is not given is as on the plane, and on the plane itself as
// on a hard floor.
struct GroundSurface {
  struct Softness {
    double stiffness_N_per_m = 0.0;  // of one contact point; a sole has four
    double damping_N_s_per_m = 0.0;
  };

  std::string material;                          // empty: not given
  std::optional<double> friction;                // Coulomb's mu; the robot file's may be less
  std::optional<double> friction_second;         // across the first direction; without it, as along it
  std::optional<double> friction_direction_rad;  // from the piece's x axis, about its z
  std::optional<Softness> softness;
  std::optional<double> bounce;  // coefficient of restitution
  std::optional<double> bounce_threshold_m_per_s;
  std::optional<double> slip_m_per_N_s;
};

// A height field that is made by chance: waves of one length from all sides, down to nothing at the rim.
struct RoughGround {
  Eigen::Isometry3d X_WF = Eigen::Isometry3d::Identity();
  Eigen::Vector2d size_m = Eigen::Vector2d::Ones();
  double spacing_m = 0.01;  // of the grid, about
  double height_m = 0.01;   // from its lowest to its highest point, the rim aside
  double wavelength_m = 0.05;
  std::optional<std::uint64_t> seed;  // without it, the scenario's
};

// A piece of ground on the plane. Its pose is in the plane's frame: origin in the world's, z the normal.
struct GroundShape {
  std::variant<FrictionPatch, GroundBox, HeightField, RoughGround> shape;
  GroundSurface surface;
};

struct Ground : GroundSurface {
  double roll_rad = 0.0;  // the plane turned about x, then about y
  double pitch_rad = 0.0;
  std::vector<GroundShape> shapes;
};

// How two materials meet, and where the scenario names them.
struct NamedMaterialPair {
  std::array<SourcedName, 2> names;
  MaterialPair pair;
};

struct Physics {
  std::uint64_t step_us = 1000;  // divides 1 ms
  Stepper stepper = Stepper::kWorld;
  int quick_iterations = 50;
  FrictionMethod friction = FrictionMethod::kLockAndCheck;
};

// A parameter of the controller, in the unit that its name ends with. Which there are, the firmware knows.
struct ParameterSetting {
  SourcedName name;
  double value = 0.0;
};

// What an operator tells the controller over the bus.
struct Command {
  enum class Kind { kEnable, kPlay, kWalk, kStop, kGetUp, kEmergencyStop, kReset };

  std::uint64_t at_us = 0;
  Kind kind = Kind::kEnable;
  std::size_t motion = 0;  // of kPlay: index into Scenario::motions
  // Of kWalk: m/s ahead and to the left, rad/s counter-clockwise.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

// A force on a link for a while.
struct Push {
  enum class Shape { kRectangle, kHalfSine };

  std::uint64_t at_us = 0;
  std::uint64_t duration_us = 0;
  SourcedName link;
  Shape shape = Shape::kRectangle;
  Eigen::Vector3d force_W_N = Eigen::Vector3d::Zero();  // peak, in world axes
  std::optional<Eigen::Vector3d> p_L_m;                 // in the link's frame; without it the centre of mass

  // The mean force over [start_us, end_us), which is not empty: whatever the physics step, the impulse is the
  // same.
  Eigen::Vector3d mean_force_W_N(std::uint64_t start_us, std::uint64_t end_us) const;
};

// Something that breaks, for a while or for the rest of the run.
struct Fault {
  enum class Kind {
    kDriveSilent,        // a drive neither hears nor answers; its motor stays as it is
    kDrivePowerLoss,     // a drive and its motor are without current
    kEncoderBreak,       // a drive no longer knows where its shaft is
    kDriveOverheat,      // the winding of a motor is too hot
    kSupplyDrop,         // the supply of all servos is limited
    kImuStop,            // the inertial unit delivers no samples
    kAnkleStop,          // an ankle sensor delivers no samples
    kControllerStop,     // the firmware stops; the board lives on
    kBusUnacknowledged,  // nobody acknowledges the controller's frames
    kBusDominant,        // a short circuit: nothing can be sent
    kFramesLost,         // receivers' controllers drop frames that were acknowledged
    kFramesCorrupted,    // bit errors on the wire
    kFramesDelayed,      // receivers are told late
    kFramesDoubled,      // receivers are told twice
    kBabblingNode,       // a further node floods the bus
  };
  // What the file calls them, in their order.
  static const std::vector<std::string>& kind_names();

  std::uint64_t at_us = 0;
  std::optional<std::uint64_t> duration_us;  // none: for the rest of the run
  Kind kind = Kind::kControllerStop;
  // The joint of faults of a drive. Of faults of frames, whose they are: a joint, kControllerTarget, or empty
  // for everybody's. The place of all others.
  SourcedName target;
  hal::Side side = hal::Side::kLeft;  // of kAnkleStop
  double highest_V = 0.0;             // of kSupplyDrop
  FrameFault frames;                  // of faults of frames; its node and times are those above
  Babble babble;                      // of kBabblingNode; so are its times

  std::uint64_t end_us() const {
    return duration_us ? at_us + *duration_us : std::numeric_limits<std::uint64_t>::max();
  }
};
inline constexpr const char* kControllerTarget = "controller";

// What the robot's controller holds when it leaves the factory: robots/ROBOT/parameters.yaml. No name twice.
struct RobotParameters {
  std::filesystem::path file;  // empty: the robot has none
  SourcedName robot;           // for which they were found
  std::vector<ParameterSetting> settings;
};

struct Scenario {
  std::filesystem::path file;
  YamlNode document{};  // what stands in the file, with the overrides; null where there is none
  std::filesystem::path robot;
  RobotParameters robot_parameters;
  std::vector<MotionChoice> motions;  // index = the number by which the controller knows it
  std::optional<GaitChoice> gait;
  std::uint64_t duration_us = 0;
  std::uint64_t seed = 1;
  double noise_scale = 1.0;               // of the sensors' random errors
  std::uint64_t computing_time_us = 500;  // of the controller, a tick
  bool teleop = false;                    // an operator takes part in the run
  Physics physics;
  Ground ground;
  std::vector<NamedMaterialPair> materials;
  InitialState initial;
  std::optional<std::filesystem::path> parameter_file;
  // Those of that file, then the scenario's own, set before the first command in this order. No name twice.
  std::vector<ParameterSetting> parameters;
  // Each in the order of time; of equal times, in the file's.
  std::vector<Command> commands;
  std::vector<Push> pushes;
  std::vector<Fault> faults;
};

// The files that decide what becomes of the scenario: itself, and those that it names.
std::vector<std::filesystem::path> input_files(const Scenario& scenario);

// Throws InputError at the first name in the scenario that the robot does not have, at a material that
// neither robot nor ground is of, at an initial joint position beyond the joint's limits, and at parameters
// of another robot.
void check(const Scenario& scenario, const RobotDescription& robot);
// The same for one push.
void check(const Push& push, const RobotDescription& robot);
// The names by which commands play its motions, in the order of the controller's numbers; a gait comes last.
std::vector<std::string> motion_names(const Scenario& scenario);

}  // namespace koboshi::sim
