#include "simulation/python/joint_level.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/text/text.h"
#include "simulation/batch/parallel.h"
#include "simulation/joint_level/joint_robots.h"
#include "simulation/python/arguments.h"
#include "simulation/python/exclusive.h"

namespace py = pybind11;

namespace koboshi::simulation {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Mask = py::array_t<bool, py::array::c_style | py::array::forcecast>;

std::span<const double> numbers(const Array& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

std::string shape_text(const py::array& array) { return py::str(array.attr("shape")); }

void check_shape(const py::array& array, const char* name, const std::vector<py::ssize_t>& expected) {
  const bool same = array.ndim() == static_cast<py::ssize_t>(expected.size()) &&
                    std::equal(expected.begin(), expected.end(), array.shape());
  if (!same)
    throw std::invalid_argument(std::string(name) + ": found an array of shape " + shape_text(array) +
                                ", expected " + std::string(py::str(py::tuple(py::cast(expected)))));
}

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

py::array_t<double> limits_array(const JointRobot& robot) {
  const auto& joints = robot.robot().joints;
  py::array_t<double> limits({static_cast<py::ssize_t>(joints.size()), py::ssize_t{2}});
  double* to = limits.mutable_data();
  for (const auto& joint : joints) {
    *to++ = joint.lower_rad;
    *to++ = joint.upper_rad;
  }
  return limits;
}

py::dict layout(const JointRobot& robot) {
  py::dict slices;
  for (const ObservationField& field : robot.fields())
    slices[py::str(field.name)] = py::slice(static_cast<py::ssize_t>(field.first),
                                            static_cast<py::ssize_t>(field.first + field.size), 1);
  return slices;
}

TrueWorld true_world(const JointRobot& robot) {
  return {robot.truth(), robot.board().world(), robot.robot(), robot.now_us()};
}

std::uint64_t time_us(double time_s) {
  if (!(time_s >= 0.0 && time_s <= 1e6))
    throw std::invalid_argument("until_s: found " + number_text(time_s) + ", expected a time of 0 s or more");
  return static_cast<std::uint64_t>(std::llround(1e6 * time_s));
}

struct RobotSnapshot {
  JointRobot::Saved saved;
  std::uint64_t time_us = 0;
};

class PyRobot {
 public:
  PyRobot(const std::filesystem::path& scenario, const std::optional<std::uint64_t>& seed,
          const std::optional<std::string>& stepper, const std::optional<std::filesystem::path>& robot,
          const std::optional<std::string>& world, const py::dict& set)
      : PyRobot(read(scenario, seed, stepper, robot, world, set)) {}

  py::array_t<double> step(const std::optional<Array>& targets, std::size_t milliseconds) {
    const Exclusive exclusive(busy_);
    if (targets) {
      check_shape(*targets, "targets_rad", {joints()});
      robot_.set_targets(numbers(*targets));
    }
    {
      const py::gil_scoped_release unlocked;
      robot_.step(milliseconds);
    }
    check_signals();
    return row();
  }
  py::array_t<double> observation() {
    const Exclusive exclusive(busy_);
    return row();
  }
  py::array_t<double> reset(const std::optional<std::uint64_t>& seed, double until_s) {
    const Exclusive exclusive(busy_);
    {
      const py::gil_scoped_release unlocked;
      robot_.reset(seed.value_or(robot_.seed()), time_us(until_s));
    }
    return row();
  }
  // Access for everything except stepping. Throws while another thread steps.
  JointRobot& idle() {
    const Exclusive exclusive(busy_);
    return robot_;
  }

 private:
  explicit PyRobot(const Scenario& scenario) : robot_(prepare_joint_level(scenario), scenario.seed) {}

  py::ssize_t joints() const { return static_cast<py::ssize_t>(robot_.robot().joints.size()); }
  py::array_t<double> row() const {
    py::array_t<double> row(static_cast<py::ssize_t>(robot_.observation_size()));
    robot_.observe({row.mutable_data(), robot_.observation_size()});
    return row;
  }

  JointRobot robot_;
  std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
};

class PyRobots {
 public:
  PyRobots(const std::filesystem::path& scenario, const std::vector<std::uint64_t>& seeds,
           const std::optional<std::size_t>& threads, const std::optional<std::string>& stepper,
           const std::optional<std::filesystem::path>& robot, const std::optional<std::string>& world,
           const py::dict& set)
      : robots_(read(scenario, std::nullopt, stepper, robot, world, set), seeds,
                threads.value_or(core_count())),
        first_(robots_.at(0)) {}

  std::size_t size() const { return robots_.size(); }
  const JointRobot& first() const { return first_; }
  py::array_t<double> step(const std::optional<Array>& targets, std::size_t milliseconds) {
    const Exclusive exclusive(busy_);
    if (targets)
      check_shape(*targets, "targets_rad", {count(), static_cast<py::ssize_t>(first_.robot().joints.size())});
    py::array_t<double> rows = empty();
    const std::span<double> to{rows.mutable_data(), static_cast<std::size_t>(rows.size())};
    const std::span<const double> from = targets ? numbers(*targets) : std::span<const double>();
    {
      const py::gil_scoped_release unlocked;
      robots_.step(from, milliseconds, to);
    }
    check_signals();
    return rows;
  }
  py::array_t<double> observations() {
    const Exclusive exclusive(busy_);
    py::array_t<double> rows = empty();
    robots_.observe({rows.mutable_data(), static_cast<std::size_t>(rows.size())});
    return rows;
  }
  py::array_t<double> reset(const std::optional<Mask>& mask,
                            const std::optional<std::vector<std::uint64_t>>& seeds, double until_s) {
    const Exclusive exclusive(busy_);
    if (mask) check_shape(*mask, "mask", {count()});
    if (seeds && seeds->size() != size())
      throw std::invalid_argument("seeds: found " + std::to_string(seeds->size()) + ", expected " +
                                  std::to_string(size()) + ", one for each robot");
    std::vector<JointRobots::Restart> restarts;
    for (std::size_t i = 0; i < size(); ++i) {
      if (!mask || mask->data()[i]) restarts.push_back({i, seeds ? (*seeds)[i] : robots_.at(i).seed()});
    }
    py::array_t<double> rows = empty();
    {
      const py::gil_scoped_release unlocked;
      robots_.reset(restarts, time_us(until_s));
      robots_.observe({rows.mutable_data(), static_cast<std::size_t>(rows.size())});
    }
    return rows;
  }
  JointRobot& idle(std::size_t robot) {
    const Exclusive exclusive(busy_);
    if (robot >= robots_.size())
      throw py::index_error("found robot " + std::to_string(robot) + ", expected one of " +
                            std::to_string(robots_.size()));
    return robots_.at(robot);
  }

 private:
  py::ssize_t count() const { return static_cast<py::ssize_t>(robots_.size()); }
  py::array_t<double> empty() const {
    return py::array_t<double>({count(), static_cast<py::ssize_t>(first_.observation_size())});
  }

  JointRobots robots_;
  const JointRobot& first_;
  std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
};

void define_robot(py::module_& module, const ObservationTypes& types) {
  using namespace py::literals;
  py::class_<RobotSnapshot>(module, "RobotSnapshot",
                            "Complete state of a Robot at one instant, made by Robot.snapshot().")
      .def_property_readonly(
          "time_s", [](const RobotSnapshot& self) { return 1e-6 * static_cast<double>(self.time_us); },
          "Simulated time of the snapshot in seconds.");
  py::class_<PyRobot>(module, "Robot",
                      R"(A robot that is controlled joint by joint, without the firmware's behaviour.

    robot = koboshi.Robot("joints", seed=1, stepper="lumped")
    targets = robot.observation()[robot.layout["joint_position_rad"]]
    for _ in range(100):
        observation = robot.step(targets)   # 10 ms

Bus, drives and sensors are those of Simulation, with their latencies, their quantisation and their noise. A new robot has
booted its drives, which hold the joints where they are. An observation has what the firmware would know at this time:
`layout` names its parts. Targets leave with the next control cycle (every 10 ms); the joints' limits bound them. There are
no feedback, no fall detection and no other protection than that of the drives.

scenario: scenario file or name without commands, motions and parameters; "joints" is one.
Other arguments are those of Simulation.)")
      .def(py::init<const std::filesystem::path&, const std::optional<std::uint64_t>&,
                    const std::optional<std::string>&, const std::optional<std::filesystem::path>&,
                    const std::optional<std::string>&, const py::dict&>(),
           "scenario"_a = "joints", py::kw_only(), "seed"_a = py::none(), "stepper"_a = py::none(),
           "robot"_a = py::none(), "world"_a = py::none(), "set"_a = py::dict())
      .def("step", &PyRobot::step, "targets_rad"_a = py::none(), "milliseconds"_a = 10,
           R"(Sets the targets of all joints, advances by this time, and returns the observation.

Without targets the last ones stay. Raises InputError for a target that is not finite, and WorldBlewUp if the physics state
is no longer finite. Other Python threads run during the call.)")
      .def("observation", &PyRobot::observation, "Returns the present observation: a row of numbers.")
      .def("reset", &PyRobot::reset, "seed"_a = py::none(), py::kw_only(), "until_s"_a = 0.0,
           "Restarts with this seed, by default the present one, boots the drives, holds the pose that they "
           "found until this simulated time, and returns the observation.")
      .def(
          "limit_torques",
          [](PyRobot& self, const Array& shares) {
            JointRobot& robot = self.idle();
            check_shape(shares, "shares", {static_cast<py::ssize_t>(robot.robot().joints.size())});
            robot.limit_torques(numbers(shares));
          },
          "shares"_a,
          "Limits the torques of the drives, as shares (0 to 1) of their rated torques. The limits travel by "
          "SDO and take "
          "some control cycles.")
      .def(
          "enable", [](PyRobot& self, bool on) { self.idle().enable(on); }, "on"_a = true,
          "Switches the torque of all drives on or off from the next control cycle on.")
      .def(
          "push",
          [](PyRobot& self, const py::object& force_N, double duration_s,
             const std::optional<std::string>& link, const py::object& at_m, const std::string& shape) {
            JointRobot& robot = self.idle();
            robot.push(read_push(robot.robot(), force_N, duration_s, link, at_m, shape));
          },
          "force_N"_a, "duration_s"_a, "link"_a = py::none(), "at_m"_a = py::none(), "shape"_a = "rectangle",
          "Applies a force to a link from now on, as Simulation.push does.")
      .def(
          "imu_samples",
          [](PyRobot& self) {
            const auto rows = self.idle().imu_samples();
            py::array_t<double> array({static_cast<py::ssize_t>(rows.size()), py::ssize_t{6}});
            double* to = array.mutable_data();
            for (const auto& row : rows) to = std::copy(row.begin(), row.end(), to);
            return array;
          },
          "Returns the samples of the inertial unit during the last step (at most 1,024), oldest first: rows "
          "of gyro (rad/s) "
          "and accelerometer (m/s^2), in its own frame.")
      .def(
          "truth",
          [types](PyRobot& self) {
            const TrueWorld world = true_world(self.idle());
            return types.truth(std::span(&world, 1), false);
          },
          "Returns the ground truth of the present instant as a Truth.")
      .def(
          "snapshot",
          [](PyRobot& self) {
            JointRobot& robot = self.idle();
            return RobotSnapshot{robot.save(), robot.now_us()};
          },
          "Returns the complete present state.")
      .def(
          "restore",
          [](PyRobot& self, const RobotSnapshot& snapshot) { self.idle().restore(snapshot.saved); },
          "snapshot"_a,
          "Returns to a snapshot of this robot, any number of times; it then continues with the same bits. "
          "Raises RuntimeError for a snapshot of another robot or from before a reset().")
      .def_property_readonly(
          "release_s", [](PyRobot& self) { return 1e-6 * static_cast<double>(self.idle().release_us()); },
          "When the scenario's stand releases the robot; 0: there is none.")
      .def_property_readonly(
          "tilt_rad", [](PyRobot& self) { return self.idle().tilt_rad(); },
          "Angle of the trunk's z axis from the vertical now, ground truth.")
      .def_property_readonly(
          "layout", [](PyRobot& self) { return layout(self.idle()); },
          "The slice of each quantity in an observation, by its name, which ends with the unit.")
      .def_property_readonly(
          "joint_limits_rad", [](PyRobot& self) { return limits_array(self.idle()); },
          "Lower and upper limit of each joint.")
      .def_property_readonly(
          "joint_names", [](PyRobot& self) { return self.idle().robot().joint_names(); },
          "Names of the joints, in the order of all arrays by joint.")
      .def_property_readonly(
          "link_names", [](PyRobot& self) { return self.idle().robot().link_names(); },
          "Names of the links, in the order of all arrays by link. The first one is the trunk.")
      .def_property_readonly(
          "fault", [](PyRobot& self) { return self.idle().fault(); },
          "The first fault of a drive in a sentence, or an empty text.")
      .def_property_readonly(
          "drawn", [](PyRobot& self) { return drawn_factors(self.idle().world(), self.idle().robot()); },
          "What the seed has drawn for this world: a text for each factor. Empty without a world.")
      .def_property_readonly(
          "time_s", [](PyRobot& self) { return 1e-6 * static_cast<double>(self.idle().now_us()); },
          "Simulated time since power-on in seconds.");
}

void define_robots(py::module_& module, const ObservationTypes& types) {
  using namespace py::literals;
  py::class_<PyRobots>(module, "Robots", R"(Robots of one scenario with different seeds, stepped in parallel.

    robots = koboshi.Robots("joints", seeds=range(16), stepper="lumped", world="rough")
    observations = robots.step(targets)     # shapes (16, observations) and (16, joints)

Each one produces the same bits as a single Robot. Arguments are those of Robot and

seeds:   one robot per seed.
threads: number of threads; default: one per core.)")
      .def(py::init<const std::filesystem::path&, const std::vector<std::uint64_t>&,
                    const std::optional<std::size_t>&, const std::optional<std::string>&,
                    const std::optional<std::filesystem::path>&, const std::optional<std::string>&,
                    const py::dict&>(),
           "scenario"_a, "seeds"_a, py::kw_only(), "threads"_a = py::none(), "stepper"_a = py::none(),
           "robot"_a = py::none(), "world"_a = py::none(), "set"_a = py::dict())
      .def("__len__", &PyRobots::size)
      .def("step", &PyRobots::step, "targets_rad"_a = py::none(), "milliseconds"_a = 10,
           "Robot.step for all: targets by robot and joint, observations by robot. If some of them raise, "
           "the others complete "
           "the step, and the first error is raised.")
      .def("observations", &PyRobots::observations, "Robot.observation of all, by robot.")
      .def("reset", &PyRobots::reset, "mask"_a = py::none(), "seeds"_a = py::none(), py::kw_only(),
           "until_s"_a = 0.0,
           "Restarts the robots whose element of the mask is true, by default all, with their seeds of this "
           "list, by default their present ones, as Robot.reset does. Returns the observations of all.")
      .def(
          "push",
          [](PyRobots& self, const py::object& force_N, double duration_s,
             const std::optional<std::size_t>& robot, const std::optional<std::string>& link,
             const py::object& at_m, const std::string& shape) {
            for (std::size_t i = robot.value_or(0); i < (robot ? *robot + 1 : self.size()); ++i) {
              JointRobot& one = self.idle(i);
              one.push(read_push(one.robot(), force_N, duration_s, link, at_m, shape));
            }
          },
          "force_N"_a, "duration_s"_a, "robot"_a = py::none(), "link"_a = py::none(), "at_m"_a = py::none(),
          "shape"_a = "rectangle", "Robot.push for one of the robots or, by default, for all.")
      .def(
          "truth",
          [types](PyRobots& self) {
            std::vector<TrueWorld> worlds;
            for (std::size_t i = 0; i < self.size(); ++i) worlds.push_back(true_world(self.idle(i)));
            return types.truth(worlds, true);
          },
          "Robot.truth with an additional leading dimension in every field: the robot.")
      .def_property_readonly(
          "release_s", [](PyRobots& self) { return 1e-6 * static_cast<double>(self.first().release_us()); },
          "As of Robot.")
      .def_property_readonly(
          "tilt_rad",
          [](PyRobots& self) {
            py::array_t<double> tilts(static_cast<py::ssize_t>(self.size()));
            for (std::size_t i = 0; i < self.size(); ++i) tilts.mutable_data()[i] = self.idle(i).tilt_rad();
            return tilts;
          },
          "Robot.tilt_rad of each.")
      .def_property_readonly(
          "faults",
          [](PyRobots& self) {
            std::vector<std::string> faults;
            for (std::size_t i = 0; i < self.size(); ++i) faults.push_back(self.idle(i).fault());
            return faults;
          },
          "Robot.fault of each.")
      .def_property_readonly(
          "layout", [](PyRobots& self) { return layout(self.first()); }, "As of Robot.")
      .def_property_readonly(
          "joint_limits_rad", [](PyRobots& self) { return limits_array(self.first()); }, "As of Robot.")
      .def_property_readonly(
          "joint_names", [](PyRobots& self) { return self.first().robot().joint_names(); }, "As of Robot.");
}

}  // namespace

void define_joint_level(py::module_& module, const ObservationTypes& types) {
  define_robot(module, types);
  define_robots(module, types);
}

}  // namespace koboshi::simulation
