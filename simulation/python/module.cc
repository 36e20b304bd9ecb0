// The Python module `koboshi`: single simulations and batches, with NumPy arrays.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim_board/input/error.h"
#include "sim_board/scenario/operator_pc.h"
#include "sim_board/world/world.h"
#include "simulation/batch/batch.h"
#include "simulation/batch/parallel.h"
#include "simulation/observe/watched_simulation.h"
#include "simulation/python/arguments.h"
#include "simulation/python/observation.h"

namespace py = pybind11;

namespace koboshi::simulation {
namespace {

// Lock that rejects concurrent use: a step runs without the GIL, and other threads get an exception
// meanwhile.
class Exclusive {
 public:
  explicit Exclusive(std::atomic_flag& flag) : flag_(flag) {
    if (flag_.test_and_set()) throw std::runtime_error("this simulation is being used in another thread");
  }
  ~Exclusive() { flag_.clear(); }
  Exclusive(const Exclusive&) = delete;
  Exclusive& operator=(const Exclusive&) = delete;

 private:
  std::atomic_flag& flag_;
};

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

// Returns the names of links or joints.
template <typename Part>
std::vector<std::string> names_of(const std::vector<Part>& parts) {
  std::vector<std::string> names;
  for (const Part& part : parts) names.push_back(part.name);
  return names;
}

class PySimulation {
 public:
  PySimulation(const std::filesystem::path& scenario, const std::optional<std::uint64_t>& seed,
               const std::optional<std::string>& stepper, const py::dict& set, bool frames)
      : keeps_frames_(frames), world_(read(scenario, seed, stepper, set)) {
    world_.keep_frames(frames);
  }

  void step(std::size_t milliseconds) {
    const Exclusive exclusive(busy_);
    step_unlocked(milliseconds, [this](std::size_t n) { world_.step(n); });
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
          const py::dict& set)
      : batch_(read(scenario, std::nullopt, stepper, set), seeds, threads.value_or(core_count())) {}

  std::size_t size() const { return batch_.size(); }
  void step(std::size_t milliseconds) {
    const Exclusive exclusive(busy_);
    step_unlocked(milliseconds, [this](std::size_t n) { batch_.step(n); });
  }
  void reset(std::size_t world, std::uint64_t seed) {
    const Exclusive exclusive(busy_);
    batch_.reset(world, seed);
  }
  WatchedSimulation& idle(std::size_t world) {
    const Exclusive exclusive(busy_);
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
  Batch batch_;
  std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
};

void define_simulation(py::module_& module, const ObservationTypes& types) {
  using namespace py::literals;
  py::class_<Snapshot>(module, "Snapshot", "The state of a Simulation at one instant (Simulation.snapshot).")
      .def_property_readonly(
          "time_s", [](const Snapshot& self) { return 1e-6 * static_cast<double>(self.time_us()); },
          "Simulated time at which it was taken.");
  py::class_<PySimulation>(module, "Simulation", R"(A robot with its firmware and board in a scenario.

    sim = koboshi.Simulation("scenarios/go.yaml", seed=1, stepper="lumped")
    sim.step(5000)
    print(sim.state().state, sim.truth().position_m)

The commands, pushes and faults of the scenario happen in their time; what the methods below do comes besides. The
same scenario, seed and calls give the same bits.

scenario: a file as docs/reference/scenario-format.md describes it.
seed:     of all random errors; without it, the scenario's.
stepper:  "world", "lumped", "quick" or "mujoco"; without it, the scenario's.
set:      values in place of the file's, by dotted path: {"ground.friction": 0.5}.
frames:   whether the frames of the bus are kept for frames().

Raises InputError with file and line for whatever a file has wrong.)")
      .def(py::init<const std::filesystem::path&, const std::optional<std::uint64_t>&,
                    const std::optional<std::string>&, const py::dict&, bool>(),
           "scenario"_a, py::kw_only(), "seed"_a = py::none(), "stepper"_a = py::none(), "set"_a = py::dict(),
           "frames"_a = false)
      .def("step", &PySimulation::step, "milliseconds"_a = 10,
           R"(Steps by so many milliseconds, past the scenario's duration too.

The firmware's control cycle is 10 ms. Other Python threads run meanwhile. Raises WorldBlewUp when the physics left the
finite, and SdoFailed when the controller refused a value of write().)")
      .def("reset", &PySimulation::reset, "seed"_a = py::none(),
           "Restarts at time zero with this seed or the previous one, and discards all calls.")
      .def("snapshot", &PySimulation::snapshot,
           "The whole state of this moment, for restore(): firmware, bus, drives, sensors, world, observers.")
      .def("restore", &PySimulation::restore, "snapshot"_a,
           R"(Goes back, or forth, to a snapshot of this simulation; it then goes on to the same bits.

    standing = sim.snapshot()
    for force_N in range(5, 50, 5):
        sim.restore(standing)
        sim.push([force_N, 0, 0], 0.1)
        sim.step(2000)

Raises RuntimeError for a snapshot of another simulation, or from before a reset().)")
      .def(
          "command",
          [](PySimulation& self, const std::string& verb, const py::object& value, const py::kwargs& fields) {
            give_command(self.idle().simulation(), verb, value, fields);
          },
          "verb"_a, "value"_a = py::none(),
          R"(Gives the firmware a command over the bus, with the next step.

    sim.command("enable")
    sim.command("walk", forward_m_per_s=0.15, turn_rad_per_s=0.2)
    sim.command("play", "squat")

The verbs and their fields are those of the list `commands` of a scenario. The firmware may refuse: events() tells.)")
      .def(
          "push",
          [](PySimulation& self, const py::object& force_N, double duration_s,
             const std::optional<std::string>& link, const py::object& at_m, const std::string& shape) {
            give_push(self.idle().simulation(), force_N, duration_s, link, at_m, shape);
          },
          "force_N"_a, "duration_s"_a, "link"_a = py::none(), "at_m"_a = py::none(), "shape"_a = "rectangle",
          R"(Pushes a link from the next step on.

force_N:    three numbers, in the axes of the world; the peak of a half sine.
duration_s: of the push.
link:       its name; without it, the trunk.
at_m:       the point, in the link's frame; without it, its centre of mass.
shape:      "rectangle" or "half-sine".)")
      .def(
          "write",
          [](PySimulation& self, const std::string& parameter, double value) {
            write(self.idle().simulation(), parameter, value);
          },
          "parameter"_a, "value"_a,
          R"(Sets a parameter of the controller by SDO, in the unit that its key ends with.

    sim.write("step_time_ms", 240)

The keys are those of docs/reference/parameters.md. Commands that follow wait until it is set.)")
      .def(
          "state",
          [types](PySimulation& self) {
            const WatchedSimulation* world = &self.idle();
            return types.state(std::span(&world, 1), false);
          },
          "Telemetry of the firmware on the bus: a State. Its arrays are copies that belong to the caller.")
      .def(
          "truth",
          [types](PySimulation& self) {
            const WatchedSimulation* world = &self.idle();
            return types.truth(std::span(&world, 1), false);
          },
          "Ground truth of the world: a Truth. Its arrays are copies that belong to the caller.")
      .def("frames", &PySimulation::frames,
           R"(The frames of the bus since the last call, in the order in which they ended.

A structured array: time_us (after the last bit), identifier, size, remote, data (8 bytes). Needs frames=True.)")
      .def(
          "events",
          [](PySimulation& self) {
            std::vector<std::pair<double, std::string>> events;
            for (const sim::RunEvent& event : self.idle().recorder().events().events())
              events.emplace_back(1e-6 * static_cast<double>(event.time_us), event.text);
            return events;
          },
          "What happened so far: pairs of a time in seconds and a sentence. The last one is the verdict.")
      .def_property_readonly(
          "verdict", [](PySimulation& self) { return self.idle().recorder().events().verdict(); },
          "\"stands; fell once at 3.2 s and got up in 3.4 s; 0 faults\".")
      .def_property_readonly(
          "state_hash", [](PySimulation& self) { return self.idle().recorder().summary().state_hash; },
          "Of every frame and of the world at every tick: that of `koboshi run` after as many milliseconds.")
      .def_property_readonly(
          "time_s", [](PySimulation& self) { return 1e-6 * static_cast<double>(self.idle().now_us()); },
          "Simulated seconds since the start.")
      .def_property_readonly(
          "finished", [](PySimulation& self) { return self.idle().simulation().finished(); },
          "Whether the scenario's duration is over.")
      .def_property_readonly(
          "joint_names", [](PySimulation& self) { return names_of(self.idle().simulation().robot().joints); },
          "In the order of all arrays by joint.")
      .def_property_readonly(
          "link_names", [](PySimulation& self) { return names_of(self.idle().simulation().robot().links); },
          "In the order of all arrays by link.");
}

void define_batch(py::module_& module, const ObservationTypes& types) {
  using namespace py::literals;
  py::class_<PyBatch>(
      module, "Simulations",
      R"(Simulations of one scenario with different seeds, stepped together on several threads.

    sims = koboshi.Simulations("scenarios/go.yaml", seeds=range(8), stepper="lumped")
    sims.step(5000)
    sims.truth().position_m          # an array of 8 by 3

Each gives the bits that it would give alone. Arguments are those of Simulation; threads: without it, one for each core.)")
      .def(py::init<const std::filesystem::path&, const std::vector<std::uint64_t>&,
                    const std::optional<std::size_t>&, const std::optional<std::string>&, const py::dict&>(),
           "scenario"_a, "seeds"_a, py::kw_only(), "threads"_a = py::none(), "stepper"_a = py::none(),
           "set"_a = py::dict())
      .def("__len__", &PyBatch::size)
      .def("step", &PyBatch::step, "milliseconds"_a = 10,
           "Steps each by so many milliseconds. If some raise, the others make their steps and the first "
           "error is raised.")
      .def("reset", &PyBatch::reset, "world"_a, "seed"_a, "Begins one of them anew, with this seed.")
      .def(
          "command",
          [](PyBatch& self, const std::string& verb, const py::object& value,
             const std::optional<std::size_t>& world, const py::kwargs& fields) {
            self.each(world, [&](Simulation& one) { give_command(one, verb, value, fields); });
          },
          "verb"_a, "value"_a = py::none(), "world"_a = py::none(),
          "As Simulation.command, to one of them or to all.")
      .def(
          "push",
          [](PyBatch& self, const py::object& force_N, double duration_s,
             const std::optional<std::size_t>& world, const std::optional<std::string>& link,
             const py::object& at_m, const std::string& shape) {
            self.each(world,
                      [&](Simulation& one) { give_push(one, force_N, duration_s, link, at_m, shape); });
          },
          "force_N"_a, "duration_s"_a, "world"_a = py::none(), "link"_a = py::none(), "at_m"_a = py::none(),
          "shape"_a = "rectangle", "As Simulation.push, to one of them or to all.")
      .def(
          "write",
          [](PyBatch& self, const std::string& parameter, double value,
             const std::optional<std::size_t>& world) {
            self.each(world, [&](Simulation& one) { write(one, parameter, value); });
          },
          "parameter"_a, "value"_a, "world"_a = py::none(), "As Simulation.write, to one of them or to all.")
      .def(
          "state", [types](PyBatch& self) { return types.state(self.all(), true); },
          "As Simulation.state; every field has one more dimension, in front: the world.")
      .def(
          "truth", [types](PyBatch& self) { return types.truth(self.all(), true); },
          "As Simulation.truth; every field has one more dimension, in front: the world.");
}

}  // namespace

PYBIND11_MODULE(koboshi, module) {
  module.doc() = "Koboshi: the firmware of a small humanoid robot on its simulated board.";
  PYBIND11_NUMPY_DTYPE(FrameRecord, time_us, identifier, size, remote, data);
  py::register_exception<sim::InputError>(module, "InputError", PyExc_ValueError).doc() =
      "A file or a value is not as it should be: file, line, what was found and what was expected.";
  py::register_exception<sim::WorldBlewUp>(module, "WorldBlewUp", PyExc_RuntimeError).doc() =
      "The physics gained energy or is no longer finite.";
  py::register_exception<sim::SdoFailed>(module, "SdoFailed", PyExc_RuntimeError).doc() =
      "The controller did not take a value.";
  const ObservationTypes types = define_observations(module);
  define_simulation(module, types);
  define_batch(module, types);
}

}  // namespace koboshi::simulation
