#include "lab/bench/bench.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <thread>
#include <utility>

#include "lab/bench/memory.h"
#include "sim_board/engine/make_world.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {
namespace {

constexpr std::uint64_t kSlice_us = 250'000;
constexpr double kSpeedup_s = 2.0;  // simulated, of each measurement with two worlds
constexpr int kSpeedupRepeats = 3;

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

simulation::Scenario read(const std::filesystem::path& file, const simulation::Physics& physics,
                          double duration_s) {
  simulation::Scenario scenario = simulation::read_scenario(file);
  scenario.physics = physics;
  scenario.duration_us = static_cast<std::uint64_t>(std::llround(1e6 * duration_s));
  return scenario;
}

using Share = double sim_board::TimeShares::*;
// The parts of a board, and how often each is timed in a millisecond of one step.
constexpr std::array<std::pair<Share, double>, 5> kParts{{{&sim_board::TimeShares::bus_s, 1.0},
                                                          {&sim_board::TimeShares::drives_s, 2.0},
                                                          {&sim_board::TimeShares::firmware_s, 1.0},
                                                          {&sim_board::TimeShares::physics_s, 1.0},
                                                          {&sim_board::TimeShares::sensors_s, 1.0}}};

// Reading the clock takes this time, the excess of each timing. The least of some attempts, which no other
// program has interrupted.
double clock_s() {
  constexpr int kAttempts = 20;
  constexpr int kReadings = 500;
  double least_s = 1.0;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const double start_s = wall_s();
    double last_s = start_s;
    for (int i = 0; i < kReadings; ++i) last_s = wall_s();
    least_s = std::min(least_s, (last_s - start_s) / kReadings);
  }
  return least_s;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// The robot stands on its feet, or lies, half a second after the stand has let go of it.
std::uint64_t at_rest_us(const simulation::Scenario& scenario) {
  return scenario.initial.release_us.value_or(0) + 500'000;
}

// One scenario on its way, with a clock that runs only while it is advanced, and the height of its trunk.
class Trial {
 public:
  enum class Measured : bool { kAll, kAtRest };

  explicit Trial(const simulation::Scenario& scenario, Measured measured = Measured::kAll)
      : simulation_(scenario),
        recorder_(simulation_, nullptr),
        measured_from_us_(measured == Measured::kAtRest ? at_rest_us(scenario) : 0) {}

  bool finished() const { return simulation_.finished() || blew_up_; }

  void advance(std::uint64_t duration_us) {
    const std::uint64_t start_us = simulation_.board().now_us();
    const std::uint64_t end_us = start_us + duration_us;
    const sim_board::TimeShares parts = simulation_.board().time_shares();
    double slice_s = 0.0;
    while (!finished() && simulation_.board().now_us() < end_us) {
      const double start_s = processor_s();
      try {
        for (int ms = 0; ms < 10 && !simulation_.finished(); ++ms) simulation_.advance();
      } catch (const sim_board::WorldBlewUp&) {
        blew_up_ = true;
      }
      slice_s += processor_s() - start_s;
      recorder_.record_tick();
      heights_m_.push_back(recorder_.truth().p_WB_W.z());
    }
    if (start_us < measured_from_us_) return;
    const double simulated_s = 1e-6 * static_cast<double>(simulation_.board().now_us() - start_us);
    simulated_s_ += simulated_s;
    time_s_ += slice_s;
    note_shares(parts, 1e3 * simulated_s, slice_s);
  }

  BenchRun result() const {
    BenchRun run;
    run.real_time_factor = simulated_s_ / time_s_;
    double sum = 0.0;
    for (std::size_t i = 0; i < kParts.size(); ++i) {
      const double share = median(shares_[i]);
      run.shares.*kParts[i].first = share;
      sum += share;
    }
    // Medians may add up to more than the whole.
    for (const auto& [part, times] : kParts) run.shares.*part /= std::max(1.0, sum);
    const double step_s = simulation_.board().world().step_s();
    run.physics_steps_per_s = simulated_s_ / step_s / (time_s_ * run.shares.physics_s);
    run.fell = recorder_.fell() || blew_up_;
    return run;
  }
  double foot_slip_m() const { return recorder_.summary().foot_slip_max_m; }
  const std::vector<double>& heights_m() const { return heights_m_; }  // by tick

 private:
  // Notes the shares of a slice in its processor time. The parts are measured by the clock on the wall, on
  // which other programs run, too; the median of all slices leaves these out.
  void note_shares(const sim_board::TimeShares& before, double simulated_ms, double processor_s) {
    if (!(processor_s > 0.0)) return;
    const sim_board::TimeShares& after = simulation_.board().time_shares();
    for (std::size_t i = 0; i < kParts.size(); ++i) {
      const auto& [part, times] = kParts[i];
      const double part_s = after.*part - before.*part - clock_s_ * times * simulated_ms;
      shares_[i].push_back(std::max(0.0, part_s) / processor_s);
    }
  }

  simulation::Simulation simulation_;
  simulation::RunRecorder recorder_;
  const double clock_s_ = clock_s();
  std::uint64_t measured_from_us_;
  std::array<std::vector<double>, kParts.size()> shares_;  // by part, of each slice
  double simulated_s_ = 0.0;
  double time_s_ = 0.0;  // of the processor
  bool blew_up_ = false;
  std::vector<double> heights_m_;
};

std::vector<double> reference_heights_m(const BenchOptions& options) {
  const simulation::Physics physics{
      .step_us = static_cast<std::uint64_t>(std::llround(1e6 * options.reference_step_s)),
      .stepper = sim_board::Stepper::kWorld};
  Trial trial(read(options.squat, physics, options.duration_s));
  while (!trial.finished()) trial.advance(kSlice_us);
  return trial.heights_m();
}

// From the tick `first` on.
double rms_m(const std::vector<double>& one_m, const std::vector<double>& other_m, std::size_t first) {
  const std::size_t count = std::min(one_m.size(), other_m.size());
  double sum_m2 = 0.0;
  for (std::size_t i = first; i < count; ++i) sum_m2 += std::pow(one_m[i] - other_m[i], 2);
  return count > first ? std::sqrt(sum_m2 / static_cast<double>(count - first)) : 0.0;
}

// The scenario until its duration after the robot has come to rest, with no commands but those that enable
// the drives, if they are wanted.
simulation::Scenario at_rest(simulation::Scenario scenario, bool with_drives) {
  std::erase_if(scenario.commands, [&](const simulation::Command& command) {
    return !with_drives || command.kind != simulation::Command::Kind::kEnable;
  });
  scenario.duration_us += at_rest_us(scenario);
  return scenario;
}

// All scenarios with one stepper.
struct Trials {
  Trials(const BenchOptions& options, const simulation::Physics& physics)
      : walk(read(options.walk, physics, options.duration_s)),
        squat(read(options.squat, physics, options.duration_s)),
        stand(at_rest(read(options.squat, physics, options.duration_s), true), Trial::Measured::kAtRest),
        lie(at_rest(read(options.lie, physics, options.duration_s), false), Trial::Measured::kAtRest) {}

  Trial walk;
  Trial squat;
  Trial stand;
  Trial lie;
};

double wall_of_threads_s(const simulation::Scenario& scenario, int threads) {
  std::vector<std::unique_ptr<simulation::Simulation>> simulations;
  for (int i = 0; i < threads; ++i) simulations.push_back(std::make_unique<simulation::Simulation>(scenario));
  const double start_s = wall_s();
  std::vector<std::jthread> running;
  for (auto& simulation : simulations) {
    running.emplace_back([&simulation] {
      while (!simulation->finished()) simulation->advance();
    });
  }
  running.clear();
  return wall_s() - start_s;
}

double two_worlds_speedup(const simulation::Scenario& scenario) {
  std::vector<double> speedups;
  for (int repeat = 0; repeat < kSpeedupRepeats; ++repeat) {
    const double one_s = wall_of_threads_s(scenario, 1);
    speedups.push_back(2.0 * one_s / wall_of_threads_s(scenario, 2));
  }
  std::ranges::sort(speedups);
  return speedups[kSpeedupRepeats / 2];
}

}  // namespace

std::vector<BenchStepper> bench_steppers() {
  std::vector<BenchStepper> steppers;
  for (const std::string& name : sim_board::stepper_names()) {
    const sim_board::Stepper stepper = *sim_board::stepper_named(name);
    if (stepper == sim_board::Stepper::kMujoco && !sim_board::has_mujoco()) continue;
    steppers.push_back({.name = name, .physics = {.stepper = stepper}});
    if (stepper == sim_board::Stepper::kWorld) {
      steppers.push_back({.name = "world_rows",
                          .physics = {.stepper = stepper, .friction = sim_board::FrictionMethod::kRows}});
    }
  }
  return steppers;
}

std::vector<BenchResult> bench(const BenchOptions& options,
                               const std::function<void(const std::string&)>& tell) {
  std::vector<BenchResult> results;
  for (const BenchStepper& stepper : options.steppers) {
    tell("memory of a world, " + stepper.name);
    results.emplace_back().stepper = stepper;
    results.back().memory_bytes = memory_of_world_bytes(read(options.walk, stepper.physics, 0.5));
  }
  std::vector<std::unique_ptr<Trials>> trials;
  for (const BenchStepper& stepper : options.steppers) {
    trials.push_back(std::make_unique<Trials>(options, stepper.physics));
  }
  tell("closed loop, all steppers in turns");
  for (bool finished = false; !finished;) {
    finished = true;
    for (Trial Trials::*which : {&Trials::walk, &Trials::squat, &Trials::stand, &Trials::lie}) {
      for (const auto& of_stepper : trials) {
        Trial& trial = (*of_stepper).*which;
        if (trial.finished()) continue;
        trial.advance(kSlice_us);
        finished = false;
      }
    }
  }
  tell("reference of the squats");
  const std::vector<double> reference_m = reference_heights_m(options);
  for (std::size_t i = 0; i < results.size(); ++i) {
    BenchResult& result = results[i];
    const simulation::Scenario squat = read(options.squat, result.stepper.physics, kSpeedup_s);
    result.walk = trials[i]->walk.result();
    result.squat = trials[i]->squat.result();
    result.stand = trials[i]->stand.result();
    result.lie = trials[i]->lie.result();
    result.squat_base_height_rms_m =
        rms_m(trials[i]->squat.heights_m(), reference_m, at_rest_us(squat) / sim_board::SimBoard::kTick_us);
    result.squat_foot_slip_m = trials[i]->squat.foot_slip_m();
    tell("two worlds, " + result.stepper.name);
    result.two_worlds_speedup = two_worlds_speedup(squat);
  }
  return results;
}

const BenchResult* fastest_accurate(const std::vector<BenchResult>& results) {
  const BenchResult* fastest = nullptr;
  for (const BenchResult& result : results) {
    if (!result.stepper.is_ode() || !result.accurate()) continue;
    if (fastest == nullptr || result.walk.real_time_factor > fastest->walk.real_time_factor)
      fastest = &result;
  }
  return fastest;
}

}  // namespace koboshi::lab
