// The Python module `koboshi`: single simulations and batches, with NumPy arrays.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/world/world.h"
#include "simulation/batch/batch.h"
#include "simulation/batch/parallel.h"
#include "simulation/observe/watched_simulation.h"
#include "simulation/python/arguments.h"
#include "simulation/python/exclusive.h"
#include "simulation/python/joint_level.h"
#include "simulation/python/observation.h"
#include "simulation/python/recording.h"
#include "simulation/scenario/operator_pc.h"

namespace py = pybind11;

namespace koboshi::simulation {
namespace {

// Steps without the GIL, so that other Python threads run. Checks for Ctrl-C periodically.
template <typename Step>
void step_unlocked(std::size_t milliseconds, const Step& step) {
  constexpr std::size_t kBetweenSignals = 500;
  while (milliseconds > 0) {
    const std::size_t now = std::min(milliseconds, kBetweenSignals);
    {
      const py::gil_scoped_release unlocked;
      step(now);
    }
    milliseconds -= now;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

struct FrameRecord {
  std::uint64_t time_us;
  std::uint16_t identifier;
  std::uint8_t size;
  bool remote;
  std::array<std::uint8_t, 8> data;
};

py::array frames_array(const std::vector<BusFrame>& frames) {
  py::array_t<FrameRecord> array(static_cast<py::ssize_t>(frames.size()));
  FrameRecord* record = array.mutable_data();
  for (const BusFrame& frame : frames) {
    *record++ = {frame.end_us, frame.frame.identifier, frame.frame.size, frame.frame.remote,
                 frame.frame.data};
  }
  return array;
}

using Events = std::vector<std::pair<double, std::string>>;

Events events_of(const WatchedSimulation& world) {
  Events events;
  for (const RunEvent& event : world.recorder().events().events())
    events.emplace_back(1e-6 * static_cast<double>(event.time_us), event.text);
  return events;
}

class PySimulation {
 public:
  PySimulation(const std::filesystem::path& scenario, const std::optional<std::uint64_t>& seed,
               const std::optional<std::string>& stepper, const std::optional<std::filesystem::path>& robot,
               const std::optional<std::string>& world, const py::dict& set, bool frames)
      : keeps_frames_(frames), world_(read(scenario, seed, stepper, robot, world, set)) {
    world_.keep_frames(frames);
  }

  void step(std::size_t milliseconds) {
    const Exclusive exclusive(busy_);
    step_unlocked(milliseconds, [this](std::size_t n) { world_.step(n); });
  }
  py::object record(std::size_t milliseconds) {
    const Exclusive exclusive(busy_);
    world_.keep_rows(true);
    try {
      step_unlocked(milliseconds, [this](std::size_t n) { world_.step(n); });
    } catch (...) {
      world_.keep_rows(false);
      throw;
    }
    const std::vector<std::vector<double>> rows{world_.take_rows()};
    world_.keep_rows(false);
    return recording(rows, world_.simulation().robot(), false);
  }
  void reset(const std::optional<std::uint64_t>& seed) {
    const Exclusive exclusive(busy_);
    world_.reset(seed.value_or(world_.simulation().scenario().seed));
  }
  Snapshot snapshot() {
    const Exclusive exclusive(busy_);
    return world_.snapshot();
  }
  void restore(const Snapshot& snapshot) {
    const Exclusive exclusive(busy_);
    world_.restore(snapshot);
  }
  // Access for everything except stepping. Throws while another thread steps.
  WatchedSimulation& idle() {
    const Exclusive exclusive(busy_);
    return world_;
  }
  py::array frames() {
    if (!keeps_frames_)
      throw py::value_error("found a simulation without frames, expected one made with frames=True");
    return frames_array(idle().take_frames());
  }

 private:
  const bool keeps_frames_;
  WatchedSimulation world_;
  std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
};

class PyBatch {
 public:
  PyBatch(const std::filesystem::path& scenario, const std::vector<std::uint64_t>& seeds,
          const std::optional<std::size_t>& threads, const std::optional<std::string>& stepper,
          const std::optional<std::filesystem::path>& robot, const std::optional<std::string>& world,
          const py::dict& set)
      : batch_(read(scenario, std::nullopt, stepper, robot, world, set), seeds,
               threads.value_or(core_count())) {}

  std::size_t size() const { return batch_.size(); }
  void step(std::size_t milliseconds) {
    const Exclusive exclusive(busy_);
    step_unlocked(milliseconds, [this](std::size_t n) { batch_.step(n); });
  }
  py::object record(std::size_t milliseconds) {
    const Exclusive exclusive(busy_);
    const std::uint64_t phase_us = batch_.at(0).now_us() % sim_board::SimBoard::kTick_us;
    for (std::size_t i = 0; i < batch_.size(); ++i)
      if (batch_.at(i).now_us() % sim_board::SimBoard::kTick_us != phase_us)
        throw std::invalid_argument(
            "found simulations at different times of the control cycle, expected the same");
    keep_rows(true);
    try {
      step_unlocked(milliseconds, [this](std::size_t n) { batch_.step(n); });
    } catch (...) {
      keep_rows(false);
      throw;
    }
    std::vector<std::vector<double>> rows;
    for (std::size_t i = 0; i < batch_.size(); ++i) rows.push_back(batch_.at(i).take_rows());
    keep_rows(false);
    return recording(rows, batch_.at(0).simulation().robot(), true);
  }
  void reset(std::size_t world, std::uint64_t seed) {
    const Exclusive exclusive(busy_);
    batch_.reset(world, seed);
  }
  void restore(const std::vector<const Snapshot*>& snapshots) {
    const Exclusive exclusive(busy_);
    if (snapshots.size() != batch_.size())
      throw std::invalid_argument("found " + std::to_string(snapshots.size()) + " snapshots, expected " +
                                  std::to_string(batch_.size()) + ", one for each simulation");
    for (std::size_t i = 0; i < batch_.size(); ++i) batch_.at(i).restore(*snapshots[i]);
  }
  WatchedSimulation& idle(std::size_t world) {
    const Exclusive exclusive(busy_);
    if (world >= batch_.size())
      throw py::index_error("found world " + std::to_string(world) + ", expected one of " +
                            std::to_string(batch_.size()));
    return batch_.at(world);
  }
  std::vector<const WatchedSimulation*> all() {
    const Exclusive exclusive(busy_);
    std::vector<const WatchedSimulation*> worlds;
    for (std::size_t i = 0; i < batch_.size(); ++i) worlds.push_back(&batch_.at(i));
    return worlds;
  }
  // Applies `act` to the simulation with index `world`, or to all of them.
  template <typename Do>
  void each(const std::optional<std::size_t>& world, const Do& act) {
    if (world) return act(idle(*world).simulation());
    for (std::size_t i = 0; i < size(); ++i) act(idle(i).simulation());
  }

 private:
  void keep_rows(bool keep) {
    for (std::size_t i = 0; i < batch_.size(); ++i) batch_.at(i).keep_rows(keep);
  }

  Batch batch_;
  std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
};

void define_simulation(py::module_& module, const ObservationTypes& types) {
  using namespace py::literals;
  py::class_<Snapshot>(module, "Snapshot",
                       "Complete state of a Simulation at one instant, made by Simulation.snapshot().")
      .def_property_readonly(
          "time_s", [](const Snapshot& self) { return 1e-6 * static_cast<double>(self.time_us()); },
          "Simulated time of the snapshot in seconds.");
  py::class_<PySimulation>(module, "Simulation",
                           R"(Simulation of a scenario: the robot with its firmware and board.

    sim = koboshi.Simulation("scenarios/go.yaml", seed=1, stepper="lumped")
    sim.step(5000)
    print(sim.state().state, sim.truth().position_m)

The calls below act in addition to the commands, pushes and faults of the scenario. The same scenario, seed and calls
produce the same bits. The world frame has its z axis upwards; the frames of the
links are those of the robot's file. Names of values end with their unit.

scenario: scenario file (docs/reference/scenario-format.md).
seed:     seed of all random errors; default: the scenario's.
stepper:  "world", "lumped" or "mujoco"; default: the scenario's.
robot:    folder, file or name of a robot; default: the scenario's.
world:    "mild", "rough" or "harsh" (docs/reference/worlds.md), drawn by the seed; default: the scenario's.
set:      values that replace those of the file, by dotted path: {"ground.friction": 0.5}.
frames:   True to record the frames on the bus for frames().

Raises InputError with file and line for an error in a file.)")
      .def(py::init<const std::filesystem::path&, const std::optional<std::uint64_t>&,
                    const std::optional<std::string>&, const std::optional<std::filesystem::path>&,
                    const std::optional<std::string>&, const py::dict&, bool>(),
           "scenario"_a, py::kw_only(), "seed"_a = py::none(), "stepper"_a = py::none(),
           "robot"_a = py::none(), "world"_a = py::none(), "set"_a = py::dict(), "frames"_a = false)
      .def("step", &PySimulation::step, "milliseconds"_a = 10,
           R"(Advances the simulation by this time, also beyond the scenario's duration.

The control cycle of the firmware is 10 ms. Other Python threads run during the call. Raises WorldBlewUp if the physics
state is no longer finite, and SdoFailed if the controller rejects a value of write().)")
      .def("record", &PySimulation::record, "milliseconds"_a,
           R"(Advances the simulation as step() does, and returns what `koboshi run` would record meanwhile.

A structured array with one row for each control cycle of 10 ms. Its fields are time_s and the columns of trace.csv
(docs/reference/recording.md); the columns of the joints are joint_target_rad, joint_encoder_rad, joint_true_rad and
joint_torque_permille, each with one value for each joint. nan: no valid value. Afterwards rows cost nothing.

    run = sim.record(5000)
    plt.plot(run["time_s"], run["joint_encoder_rad"][:, sim.joint_names.index("left_knee")]))")
      .def("reset", &PySimulation::reset, "seed"_a = py::none(),
           "Restarts at time zero with this seed, by default the present one. Discards the effects of all "
           "calls.")
      .def("snapshot", &PySimulation::snapshot,
           "Returns the complete present state: firmware, bus, drives, sensors, world and observers.")
      .def("restore", &PySimulation::restore, "snapshot"_a,
           R"(Returns to a snapshot of this simulation. The simulation then continues with the same bits.

    standing = sim.snapshot()
    for force_N in range(5, 50, 5):
        sim.restore(standing)
        sim.push([force_N, 0, 0], 0.1)
        sim.step(2000)

Raises RuntimeError for a snapshot of another simulation or from before a reset().)")
      .def(
          "command",
          [](PySimulation& self, const std::string& verb, const py::object& value, const py::kwargs& fields) {
            give_command(self.idle().simulation(), verb, value, fields);
          },
          "verb"_a, "value"_a = py::none(),
          R"(Sends a command to the firmware over the bus at the next step.

    sim.command("enable")
    sim.command("walk", forward_m_per_s=0.15, turn_rad_per_s=0.2)
    sim.command("play", "squat")

Verbs and fields are those of the list `commands` of a scenario. events() reports whether the firmware refuses it.)")
      .def(
          "stream",
          [](PySimulation& self, const py::object& targets_rad, const py::object& torque_limits_percent) {
            self.idle().simulation().stream(stream_set(targets_rad, torque_limits_percent));
          },
          "targets_rad"_a, "torque_limits_percent"_a = py::none(),
          R"(Sends one set of joint targets to the firmware, which follows them within limits and highest speeds.

    sim.command("stream")             # the robot stands; now it follows
    for _ in range(100):
        sim.stream(targets_rad)       # one for each joint
        sim.step(10)
    sim.command("stop")               # back to the standing pose

torque_limits_percent: one for each joint, 1 to 100; by default they stay. Without a set for 100 ms, at a fall and at low
supply the stream ends.)")
      .def(
          "push",
          [](PySimulation& self, const py::object& force_N, double duration_s,
             const std::optional<std::string>& link, const py::object& at_m, const std::string& shape) {
            give_push(self.idle().simulation(), force_N, duration_s, link, at_m, shape);
          },
          "force_N"_a, "duration_s"_a, "link"_a = py::none(), "at_m"_a = py::none(), "shape"_a = "rectangle",
          R"(Applies a force to a link from the next step on.

force_N:    three components in the axes of the world; for a half sine, the peak.
duration_s: duration of the push.
link:       name of the link; default: the trunk.
at_m:       point of application in the frame of the link; default: its centre of mass.
shape:      "rectangle" or "half-sine".)")
      .def(
          "write",
          [](PySimulation& self, const std::string& parameter, double value) {
            write(self.idle().simulation(), parameter, value);
          },
          "parameter"_a, "value"_a,
          R"(Writes a parameter of the controller by SDO, in the unit at the end of its key.

    sim.write("step_time_ms", 240)

docs/reference/parameters.md lists the keys. Later commands are sent after the controller has accepted the value.)")
      .def(
          "state",
          [types](PySimulation& self) {
            const WatchedSimulation* world = &self.idle();
            return types.state(std::span(&world, 1), false);
          },
          "Returns the telemetry of the firmware on the bus as a State. Its arrays are copies.")
      .def(
          "truth",
          [types](PySimulation& self) {
            const WatchedSimulation* world = &self.idle();
            return types.truth(std::span(&world, 1), false);
          },
          "Returns the ground truth of the world as a Truth. Its arrays are copies.")
      .def("frames", &PySimulation::frames,
           R"(Returns the CAN frames since the last call, in the order of their ends. Requires frames=True.

A structured array with the fields time_us (end of the last bit), identifier, size, remote and data (8 bytes).)")
      .def(
          "events", [](PySimulation& self) { return events_of(self.idle()); },
          "Returns the events of the run (docs/reference/events.md) as pairs of a time in seconds and a "
          "sentence.")
      .def_property_readonly(
          "drawn",
          [](PySimulation& self) {
            const Simulation& simulation = self.idle().simulation();
            return drawn_factors(simulation.world(), simulation.robot());
          },
          "What the seed has drawn for this world: a text for each factor. Empty without a world.")
      .def_property_readonly(
          "verdict", [](PySimulation& self) { return self.idle().recorder().events().verdict(); },
          "Outcome in one sentence: \"stands; fell once at 3.2 s and got up in 3.4 s; 0 faults\".")
      .def_property_readonly(
          "state_hash", [](PySimulation& self) { return self.idle().recorder().summary().state_hash; },
          "Hash of all frames and of the world at every tick, equal to that of `koboshi run` after the same "
          "time.")
      .def_property_readonly(
          "time_s", [](PySimulation& self) { return 1e-6 * static_cast<double>(self.idle().now_us()); },
          "Simulated time since the start in seconds.")
      .def_property_readonly(
          "finished", [](PySimulation& self) { return self.idle().simulation().finished(); },
          "True if the scenario's duration has passed.")
      .def_property_readonly(
          "joint_names", [](PySimulation& self) { return self.idle().simulation().robot().joint_names(); },
          "Names of the joints, in the order of all arrays by joint.")
      .def_property_readonly(
          "link_names", [](PySimulation& self) { return self.idle().simulation().robot().link_names(); },
          "Names of the links, in the order of all arrays by link. The first one is the trunk.");
}

void define_batch(py::module_& module, const ObservationTypes& types) {
  using namespace py::literals;
  py::class_<PyBatch>(module, "Simulations",
                      R"(Simulations of one scenario with different seeds, stepped in parallel.

    sims = koboshi.Simulations("scenarios/go.yaml", seeds=range(8), stepper="lumped")
    sims.step(5000)
    sims.truth().position_m          # array of shape (8, 3)

Each one produces the same bits as a single Simulation. Arguments are those of Simulation and

seeds:   one simulation per seed.
threads: number of threads; default: one per core.)")
      .def(py::init<const std::filesystem::path&, const std::vector<std::uint64_t>&,
                    const std::optional<std::size_t>&, const std::optional<std::string>&,
                    const std::optional<std::filesystem::path>&, const std::optional<std::string>&,
                    const py::dict&>(),
           "scenario"_a, "seeds"_a, py::kw_only(), "threads"_a = py::none(), "stepper"_a = py::none(),
           "robot"_a = py::none(), "world"_a = py::none(), "set"_a = py::dict())
      .def("__len__", &PyBatch::size)
      .def("step", &PyBatch::step, "milliseconds"_a = 10,
           "Advances each simulation by this time. If some of them raise, the others complete the step, and "
           "the "
           "first error is raised.")
      .def(
          "record", &PyBatch::record, "milliseconds"_a,
          "Simulation.record with a leading dimension: the simulation. The array has the shape (simulations, "
          "control cycles).")
      .def("reset", &PyBatch::reset, "world"_a, "seed"_a, "Restarts one of the simulations with this seed.")
      .def(
          "command",
          [](PyBatch& self, const std::string& verb, const py::object& value,
             const std::optional<std::size_t>& world, const py::kwargs& fields) {
            self.each(world, [&](Simulation& one) { give_command(one, verb, value, fields); });
          },
          "verb"_a, "value"_a = py::none(), "world"_a = py::none(),
          "Simulation.command for one of the simulations or, by default, for all.")
      .def(
          "stream",
          [](PyBatch& self, const py::object& targets_rad, const py::object& torque_limits_percent,
             const std::optional<std::size_t>& world) {
            if (world) {
              self.idle(*world).simulation().stream(stream_set(targets_rad, torque_limits_percent));
              return;
            }
            const std::vector<StreamSet> sets = stream_sets(targets_rad, torque_limits_percent, self.size());
            for (std::size_t i = 0; i < self.size(); ++i) self.idle(i).simulation().stream(sets[i]);
          },
          "targets_rad"_a, "torque_limits_percent"_a = py::none(), "world"_a = py::none(),
          "Simulation.stream for one of the simulations or, by default, for all: arrays of shape "
          "(simulations, "
          "joints), or (joints,) for the same in each.")
      .def(
          "push",
          [](PyBatch& self, const py::object& force_N, double duration_s,
             const std::optional<std::size_t>& world, const std::optional<std::string>& link,
             const py::object& at_m, const std::string& shape) {
            self.each(world,
                      [&](Simulation& one) { give_push(one, force_N, duration_s, link, at_m, shape); });
          },
          "force_N"_a, "duration_s"_a, "world"_a = py::none(), "link"_a = py::none(), "at_m"_a = py::none(),
          "shape"_a = "rectangle", "Simulation.push for one of the simulations or, by default, for all.")
      .def(
          "write",
          [](PyBatch& self, const std::string& parameter, double value,
             const std::optional<std::size_t>& world) {
            self.each(world, [&](Simulation& one) { write(one, parameter, value); });
          },
          "parameter"_a, "value"_a, "world"_a = py::none(),
          "Simulation.write for one of the simulations or, by default, for all.")
      .def(
          "state", [types](PyBatch& self) { return types.state(self.all(), true); },
          "Simulation.state with an additional leading dimension in every field: the simulation.")
      .def(
          "truth", [types](PyBatch& self) { return types.truth(self.all(), true); },
          "Simulation.truth with an additional leading dimension in every field: the simulation.")
      .def(
          "events",
          [](PyBatch& self) {
            std::vector<Events> events;
            for (const WatchedSimulation* world : self.all()) events.push_back(events_of(*world));
            return events;
          },
          "Simulation.events of each simulation, in a list.")
      .def(
          "snapshot",
          [](PyBatch& self) {
            std::vector<Snapshot> snapshots;
            for (std::size_t i = 0; i < self.size(); ++i) snapshots.push_back(self.idle(i).snapshot());
            return snapshots;
          },
          "Simulation.snapshot of each simulation, in a list.")
      .def(
          "restore", &PyBatch::restore, "snapshots"_a,
          "Returns all simulations to their snapshots, a list as snapshot() makes it. Raises RuntimeError as "
          "Simulation.restore does.")
      .def_property_readonly(
          "verdicts",
          [](PyBatch& self) {
            std::vector<std::string> verdicts;
            for (const WatchedSimulation* world : self.all())
              verdicts.push_back(world->recorder().events().verdict());
            return verdicts;
          },
          "Simulation.verdict of each simulation.")
      .def_property_readonly(
          "time_s",
          [](PyBatch& self) {
            std::vector<double> times_s;
            for (const WatchedSimulation* world : self.all())
              times_s.push_back(1e-6 * static_cast<double>(world->now_us()));
            return py::array_t<double>(static_cast<py::ssize_t>(times_s.size()), times_s.data());
          },
          "Simulated time of each simulation in seconds, an array.")
      .def_property_readonly(
          "joint_names", [](PyBatch& self) { return self.idle(0).simulation().robot().joint_names(); },
          "Names of the joints, in the order of all arrays by joint.")
      .def_property_readonly(
          "link_names", [](PyBatch& self) { return self.idle(0).simulation().robot().link_names(); },
          "Names of the links, in the order of all arrays by link. The first one is the trunk.");
}

}  // namespace

PYBIND11_MODULE(koboshi, module) {
  try {
    py::module_::import("numpy");
  } catch (const py::error_already_set&) {
    throw std::runtime_error(
        "koboshi needs NumPy, which this interpreter does not have (on Debian: /usr/bin/python3 with the "
        "package "
        "python3-numpy)");
  }
  module.doc() = "Koboshi: the firmware of a small humanoid robot on its simulated board.";
  PYBIND11_NUMPY_DTYPE(FrameRecord, time_us, identifier, size, remote, data);
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).doc() =
      "Invalid file or value: file, line, what was found and what was expected.";
  // Bad arguments and files that cannot be opened are input errors, too.
  py::register_exception_translator([](std::exception_ptr pointer) {
    const auto raise = [](const std::string& text) {
      const py::object type = py::module_::import("koboshi").attr("InputError");
      PyErr_SetString(type.ptr(), utf8_text(text).c_str());
    };
    try {
      std::rethrow_exception(pointer);
    } catch (const std::invalid_argument& error) {
      raise(error.what());
    } catch (const std::filesystem::filesystem_error& error) {
      raise("cannot use " + error.path1().string() + ": " + error.code().message());
    }
  });
  py::register_exception<sim_board::WorldBlewUp>(module, "WorldBlewUp", PyExc_RuntimeError).doc() =
      "The physics state gained energy or is no longer finite.";
  py::register_exception<SdoFailed>(module, "SdoFailed", PyExc_RuntimeError).doc() =
      "The controller rejected a value.";
  module.attr("__version__") = KOBOSHI_VERSION;
  const ObservationTypes types = define_observations(module);
  define_simulation(module, types);
  define_batch(module, types);
  define_joint_level(module, types);
}

}  // namespace koboshi::simulation
