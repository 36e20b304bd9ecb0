// How much two threads of one batch advance compared with two processes, one simulation each, and what it
// costs to create and to reset a simulation whose files are read. Both kinds are timed in turn within one
// run, so that other load on the machine meets both. Prints one JSON document.
//
//   batch_bench [STEPPER [REPETITIONS [MILLISECONDS]]]

#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "simulation/batch/batch.h"
#include "simulation/scenario/reader.h"

namespace {

using namespace koboshi;
using Clock = std::chrono::steady_clock;

constexpr std::array<std::uint64_t, 2> kSeeds{1, 2};
enum Command : char { kStep = 's', kReset = 'r', kQuit = 'q' };

double milliseconds_of(const std::function<void()>& task) {
  const auto start = Clock::now();
  task();
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void check(bool done, const char* what) {
  if (!done) throw std::runtime_error(what);
}

// A process with a batch of one simulation, which steps or resets when it is told to.
class Worker {
 public:
  // To be created before this process has threads.
  Worker(const simulation::Scenario& scenario, std::uint64_t seed, std::size_t milliseconds) {
    check(::pipe(commands_.data()) == 0 && ::pipe(answers_.data()) == 0, "pipe failed");
    process_ = ::fork();
    check(process_ >= 0, "fork failed");
    if (process_ == 0) std::_Exit(serve(scenario, seed, milliseconds));
    ::close(commands_[0]);
    ::close(answers_[1]);
  }
  // The end is sent as a command: closing the pipe would not be noticed, because later workers have
  // inherited this end of it.
  ~Worker() {
    const char command = kQuit;
    static_cast<void>(!::write(commands_[1], &command, 1));
    ::close(commands_[1]);
    ::waitpid(process_, nullptr, 0);
    ::close(answers_[0]);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void begin(char command) { check(::write(commands_[1], &command, 1) == 1, "a worker is gone"); }
  void await() {
    char answer = 0;
    check(::read(answers_[0], &answer, 1) == 1, "a worker has failed");
  }

 private:
  int serve(const simulation::Scenario& scenario, std::uint64_t seed, std::size_t milliseconds) {
    ::close(commands_[1]);
    ::close(answers_[0]);
    simulation::Batch batch(scenario, std::array{seed}, 1);
    for (char command = 0; ::read(commands_[0], &command, 1) == 1 && command != kQuit;) {
      if (command == kStep) batch.step(milliseconds);
      if (command == kReset) batch.reset(0, seed);
      if (::write(answers_[1], &command, 1) != 1) return 1;
    }
    return 0;
  }

  std::array<int, 2> commands_{};
  std::array<int, 2> answers_{};
  pid_t process_ = 0;
};

class Processes {
 public:
  Processes(const simulation::Scenario& scenario, std::size_t milliseconds) {
    for (const std::uint64_t seed : kSeeds)
      workers_.push_back(std::make_unique<Worker>(scenario, seed, milliseconds));
  }
  void all(char command) {
    for (const auto& worker : workers_) worker->begin(command);
    for (const auto& worker : workers_) worker->await();
  }

 private:
  std::vector<std::unique_ptr<Worker>> workers_;
};

struct Times {
  std::vector<double> threads_ms;
  std::vector<double> processes_ms;
  std::vector<double> ratios;  // of the throughput, by repetition
};

Times compare(const simulation::Scenario& scenario, int repetitions, std::size_t milliseconds) {
  Processes processes(scenario, milliseconds);
  simulation::Batch batch(scenario, kSeeds, kSeeds.size());
  Times times;
  for (int i = 0; i < repetitions; ++i) {
    for (std::size_t world = 0; world < kSeeds.size(); ++world) batch.reset(world, kSeeds[world]);
    processes.all(kReset);
    const auto threads = [&] { return milliseconds_of([&] { batch.step(milliseconds); }); };
    const auto apart = [&] { return milliseconds_of([&] { processes.all(kStep); }); };
    // Each is the first every other time.
    const double first_ms = i % 2 == 0 ? threads() : apart();
    const double second_ms = i % 2 == 0 ? apart() : threads();
    times.threads_ms.push_back(i % 2 == 0 ? first_ms : second_ms);
    times.processes_ms.push_back(i % 2 == 0 ? second_ms : first_ms);
    times.ratios.push_back(times.processes_ms.back() / times.threads_ms.back());
  }
  return times;
}

void print(const simulation::Scenario& scenario, int repetitions, std::size_t milliseconds) {
  const Times times = compare(scenario, repetitions, milliseconds);
  const auto prepared = std::make_shared<const simulation::PreparedScenario>(simulation::prepare(scenario));
  std::unique_ptr<simulation::WatchedSimulation> world;
  std::vector<double> create_ms;
  std::vector<double> reset_ms;
  for (int i = 0; i < 20; ++i) {
    create_ms.push_back(
        milliseconds_of([&] { world = std::make_unique<simulation::WatchedSimulation>(prepared, 1); }));
    world->step(20);
    reset_ms.push_back(milliseconds_of([&] { world->reset(2); }));
  }
  const auto least = [](const std::vector<double>& values) { return *std::ranges::min_element(values); };
  fmt::print(
      "{{\n  \"two_threads_to_two_processes_median\": {:.3f},\n"
      "  \"two_threads_to_two_processes_of_shortest\": {:.3f},\n  \"threads_ms\": {:.1f},\n"
      "  \"processes_ms\": {:.1f},\n  \"create_ms_median\": {:.2f},\n  \"create_ms_least\": {:.2f},\n"
      "  \"reset_ms_median\": {:.2f},\n  \"reset_ms_least\": {:.2f}\n}}\n",
      median(times.ratios), least(times.processes_ms) / least(times.threads_ms), median(times.threads_ms),
      median(times.processes_ms), median(create_ms), least(create_ms), median(reset_ms), least(reset_ms));
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Override> overrides{{"physics.stepper", argc > 1 ? argv[1] : "lumped"}};
  try {
    print(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml", overrides),
          argc > 2 ? std::atoi(argv[2]) : 21, argc > 3 ? static_cast<std::size_t>(std::atoi(argv[3])) : 500);
  } catch (const std::exception& error) {
    fmt::print(stderr, "batch_bench: {}\n", error.what());
    return 2;
  }
}
