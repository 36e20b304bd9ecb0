#include "simulation/python/observation.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "simulation/observe/event_words.h"

namespace py = pybind11;

namespace koboshi::simulation {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

// Placeholders in a field's shape for the robot's number of joints and of links. The size of a field is the
// product of its shape.
constexpr py::ssize_t kJoints = -1;
constexpr py::ssize_t kLinks = -2;

template <typename World>
using Worlds = std::span<const World* const>;

// A field of numbers that is read from a World: from a WatchedSimulation or a TrueWorld.
template <typename World>
struct Field {
  const char* name;
  std::vector<py::ssize_t> shape;  // empty: a scalar
  const char* meaning;
  std::function<void(const World&, double*)> read;
};

template <typename World>
struct TextField {
  const char* name;
  const char* meaning;
  std::function<std::string(const World&)> read;
};

template <typename Numbers>
void copy(const Numbers& numbers, double* to) {
  std::copy(std::begin(numbers), std::end(numbers), to);
}

const Telemetry& said(const WatchedSimulation& world) { return world.recorder().telemetry(); }
const GroundTruth& truth(const TrueWorld& world) { return world.truth; }

const sim_board::RobotDescription& robot_of(const WatchedSimulation& world) {
  return world.simulation().robot();
}
const sim_board::RobotDescription& robot_of(const TrueWorld& world) { return world.robot; }
std::size_t joints(const auto& world) { return robot_of(world).joints.size(); }
std::size_t links(const auto& world) { return robot_of(world).links.size(); }

// Field with one value per joint.
template <typename Number>
auto by_joint(Number number) {
  return [number](const auto& world, double* to) {
    for (std::size_t joint = 0; joint < joints(world); ++joint) *to++ = number(world, joint);
  };
}

// Field with several values per link, from the body's present state in the world.
template <typename Numbers>
auto by_link(Numbers numbers) {
  return [numbers](const TrueWorld& world, double* to) {
    for (std::size_t link = 0; link < links(world); ++link) {
      const sim_board::BodyState body = world.world.body(static_cast<int>(link));
      for (const double number : numbers(body)) *to++ = number;
    }
  };
}

sim_board::JointState true_joint(const TrueWorld& world, std::size_t joint) {
  return world.world.joint(static_cast<int>(joint));
}

double time_s(const WatchedSimulation& world) { return 1e-6 * static_cast<double>(world.now_us()); }
double time_s(const TrueWorld& world) { return 1e-6 * static_cast<double>(world.now_us); }

const std::vector<TextField<WatchedSimulation>>& state_texts() {
  static const std::vector<TextField<WatchedSimulation>> kFields{
      {"state", "state of the firmware: \"limp\", \"standing\", \"walking\" ...",
       [](const auto& world) { return name_of(said(world).state); }},
      {"reason", "reason of the present state (docs/reference/behaviour.md)",
       [](const auto& world) { return name_of(said(world).reason); }}};
  return kFields;
}

const std::vector<Field<WatchedSimulation>>& state_fields() {
  static const std::vector<Field<WatchedSimulation>> kFields{
      {"time_s",
       {},
       "simulated seconds since the start",
       [](const auto& world, double* to) { *to = time_s(world); }},
      {"attitude_rad",
       {2},
       "roll and pitch of the trunk, estimated from gyro and accelerometer",
       [](const auto& world, double* to) { to[0] = said(world).roll_rad, to[1] = said(world).pitch_rad; }},
      {"rate_rad_per_s",
       {3},
       "filtered gyro rates without bias, in the trunk's axes",
       [](const auto& world, double* to) { copy(said(world).rate_rad_per_s, to); }},
      {"foot_load_N",
       {2},
       "normal force at the left and right ankle sensor",
       [](const auto& world, double* to) { copy(said(world).foot_load_N, to); }},
      {"foot_zmp_m",
       {2, 2},
       "x and y of the ZMP of the left and right foot, each in the frame of its sole; nan: invalid",
       [](const auto& world, double* to) {
         for (const Telemetry::FootZmp& zmp : said(world).foot_zmp) {
           *to++ = zmp.valid ? zmp.x_m : kNotANumber;
           *to++ = zmp.valid ? zmp.y_m : kNotANumber;
         }
       }},
      {"zmp_m",
       {2},
       "x and y of the ZMP of both feet, in the frame of the sole with more load; nan: invalid",
       [](const auto& world, double* to) {
         const Telemetry::Zmp& zmp = said(world).zmp;
         *to++ = zmp.valid ? zmp.x_m : kNotANumber;
         *to++ = zmp.valid ? zmp.y_m : kNotANumber;
       }},
      {"com_m",
       {3},
       "centre of mass from the joint angles, in the frame of the sole with more load",
       [](const auto& world, double* to) { copy(said(world).com_S_m, to); }},
      {"dcm_m",
       {2},
       "x and y of the divergent component of motion, in the frame of the sole of dcm_side; nan: invalid",
       [](const auto& world, double* to) {
         const Telemetry::ComMotion& motion = said(world).com_motion;
         for (const double value : motion.dcm_m) *to++ = motion.valid ? value : kNotANumber;
       }},
      {"dcm_error_m",
       {2},
       "dcm_m less the plan of a walk for its moment; nan outside of a walk",
       [](const auto& world, double* to) {
         const Telemetry::ComMotion& motion = said(world).com_motion;
         for (const double value : motion.dcm_error_m) *to++ = motion.compared ? value : kNotANumber;
       }},
      {"dcm_side",
       {},
       "the foot in whose sole's frame dcm_m is: 0 left, 1 right",
       [](const auto& world, double* to) { *to = static_cast<double>(said(world).com_motion.frame); }},
      {"foot_touches",
       {2},
       "1 while the left and the right foot bear load, by the firmware",
       [](const auto& world, double* to) {
         for (const bool touches : said(world).com_motion.touches) *to++ = touches ? 1.0 : 0.0;
       }},
      {"odometer",
       {3},
       "x and y of the trunk in m and its heading in rad, since power-on, by the firmware; ten times a "
       "second",
       [](const auto& world, double* to) {
         const Telemetry::Place& place = said(world).place;
         to[0] = place.x_m, to[1] = place.y_m, to[2] = place.heading_rad;
       }},
      {"slope_rad",
       {2},
       "slope of the ground along the sole's axes, uphill positive, when the robot last stood still; nan: "
       "unknown",
       [](const auto& world, double* to) {
         const Telemetry::Place& place = said(world).place;
         for (const double slope : place.slope_rad) *to++ = place.ground_valid ? slope : kNotANumber;
       }},
      {"joint_target_rad", {kJoints}, "targets of the drives", by_joint([](const auto& world, std::size_t i) {
         return said(world).joints[i].target_rad;
       })},
      {"joint_position_rad",
       {kJoints},
       "positions from the encoders",
       by_joint([](const auto& world, std::size_t i) { return said(world).joints[i].position_rad; })},
      {"joint_torque_permille",
       {kJoints},
       "torques as estimated by the drives, in 1/1000 of their rated torque",
       by_joint([](const auto& world, std::size_t i) { return said(world).joints[i].torque_permille; })}};
  return kFields;
}

const std::vector<Field<TrueWorld>>& truth_fields() {
  static const std::vector<Field<TrueWorld>> kFields{
      {"time_s",
       {},
       "simulated seconds since the start",
       [](const auto& world, double* to) { *to = time_s(world); }},
      {"position_m",
       {3},
       "origin of the trunk in the world, at the last tick (every 10 ms)",
       [](const auto& world, double* to) { copy(truth(world).p_WB_W, to); }},
      {"rpy_rad",
       {3},
       "roll, pitch, yaw of the trunk, R = Rz(yaw) Ry(pitch) Rx(roll), at the last tick",
       [](const auto& world, double* to) { copy(truth(world).rpy_rad, to); }},
      {"rate_rad_per_s",
       {3},
       "angular velocity of the trunk in the axes of the world, at the last tick",
       [](const auto& world, double* to) { copy(truth(world).w_WB_W, to); }},
      {"tilt_rad",
       {},
       "angle of the trunk's z axis from the vertical, at the last tick",
       [](const auto& world, double* to) { *to = truth(world).tilt_rad; }},
      {"com_m",
       {3},
       "centre of mass in the world, at the last tick",
       [](const auto& world, double* to) { copy(truth(world).p_WCom_W, to); }},
      {"zmp_m",
       {3},
       "centre of pressure of all loaded feet in the world, at the last tick; nan: no load",
       [](const auto& world, double* to) {
         copy(truth(world).p_WZmp_W.value_or(Eigen::Vector3d::Constant(kNotANumber)), to);
       }},
      {"zmp_margin_m",
       {},
       "distance of zmp_m from the edge of the support polygon, positive inside; nan: no load",
       [](const auto& world, double* to) { *to = truth(world).zmp_margin_m.value_or(kNotANumber); }},
      {"foot_load_N",
       {2},
       "normal force of the ground on the left and right foot, at the last tick",
       [](const auto& world, double* to) { copy(truth(world).foot_load_N, to); }},
      {"joint_position_rad",
       {kJoints},
       "positions of the joints, now",
       by_joint([](const auto& world, std::size_t i) { return true_joint(world, i).position_rad; })},
      {"joint_speed_rad_per_s",
       {kJoints},
       "speeds of the joints, now",
       by_joint([](const auto& world, std::size_t i) { return true_joint(world, i).speed_rad_per_s; })},
      {"joint_torque_Nm",
       {kJoints},
       "torques of the servos on the joints' child links in the last step",
       by_joint([](const auto& world, std::size_t i) { return true_joint(world, i).servo_Nm; })},
      {"link_position_m",
       {kLinks, 3},
       "origins of the links in the world, now",
       by_link([](const sim_board::BodyState& body) -> Eigen::Vector3d { return body.X_WL.translation(); })},
      {"link_rotation",
       {kLinks, 3, 3},
       "rotation matrices from the links' frames to the world, now",
       by_link([](const sim_board::BodyState& body) {
         std::array<double, 9> rows;
         for (int i = 0; i < 9; ++i) rows[static_cast<std::size_t>(i)] = body.X_WL.linear()(i / 3, i % 3);
         return rows;
       })}};
  return kFields;
}

template <typename World>
py::object numbers(const Field<World>& field, Worlds<World> worlds, bool by_world) {
  std::vector<py::ssize_t> shape;
  if (by_world) shape.push_back(static_cast<py::ssize_t>(worlds.size()));
  py::ssize_t size = 1;
  for (const py::ssize_t length : field.shape) {
    const World& first = *worlds.front();
    const py::ssize_t actual = length == kJoints  ? static_cast<py::ssize_t>(joints(first))
                               : length == kLinks ? static_cast<py::ssize_t>(links(first))
                                                  : length;
    shape.push_back(actual);
    size *= actual;
  }
  if (shape.empty()) {
    double number = 0.0;
    field.read(*worlds.front(), &number);
    return py::float_(number);
  }
  py::array_t<double> array(shape);
  double* to = array.mutable_data();
  for (const World* world : worlds) {
    field.read(*world, to);
    to += size;
  }
  return array;
}

template <typename World>
py::object texts(const TextField<World>& field, Worlds<World> worlds, bool by_world) {
  if (!by_world) return py::str(field.read(*worlds.front()));
  std::vector<std::string> all;
  for (const World* world : worlds) all.push_back(field.read(*world));
  return py::module_::import("numpy").attr("array")(all);
}

template <typename World>
py::object define(py::module_& module, const char* name, const std::string& title,
                  const std::vector<TextField<World>>& text_fields, const std::vector<Field<World>>& fields) {
  py::list names;
  std::string doc = title + "\n";
  const auto add = [&](const char* field, const char* meaning) {
    names.append(field);
    doc += std::string("\n") + field + ": " + meaning;
  };
  for (const TextField<World>& field : text_fields) add(field.name, field.meaning);
  for (const Field<World>& field : fields) add(field.name, field.meaning);
  py::object type = py::module_::import("collections").attr("namedtuple")(name, names);
  type.attr("__doc__") = doc;
  type.attr("__module__") = "koboshi";
  module.attr(name) = type;
  return type;
}

template <typename World>
py::object make(const py::object& type, const std::vector<TextField<World>>& text_fields,
                const std::vector<Field<World>>& fields, Worlds<World> worlds, bool by_world) {
  py::list values;
  for (const TextField<World>& field : text_fields) values.append(texts(field, worlds, by_world));
  for (const Field<World>& field : fields) values.append(numbers(field, worlds, by_world));
  return type.attr("_make")(values);
}

}  // namespace

ObservationTypes::ObservationTypes(py::module_& module)
    : state_type_(
          define(module, "State", "Telemetry of the firmware on the bus.", state_texts(), state_fields())),
      truth_type_(define(module, "Truth", "Ground truth of the robot in the world.",
                         std::vector<TextField<TrueWorld>>(), truth_fields())) {}

py::object ObservationTypes::state(std::span<const WatchedSimulation* const> worlds, bool by_world) const {
  return make(state_type_, state_texts(), state_fields(), worlds, by_world);
}

py::object ObservationTypes::truth(std::span<const WatchedSimulation* const> worlds, bool by_world) const {
  std::vector<TrueWorld> truths;
  for (const WatchedSimulation* world : worlds)
    truths.push_back({world->recorder().truth(), world->simulation().board().world(),
                      world->simulation().robot(), world->now_us()});
  return truth(truths, by_world);
}

py::object ObservationTypes::truth(std::span<const TrueWorld> worlds, bool by_world) const {
  std::vector<const TrueWorld*> pointers;
  for (const TrueWorld& world : worlds) pointers.push_back(&world);
  return make(truth_type_, std::vector<TextField<TrueWorld>>(), truth_fields(), Worlds<TrueWorld>(pointers),
              by_world);
}

ObservationTypes define_observations(py::module_& module) { return ObservationTypes(module); }

}  // namespace koboshi::simulation
