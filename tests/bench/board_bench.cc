// Measures a tick of 10 ms without the physics: firmware, bus, drives, sensors and recording, over a run of
// squats, quoted beside a calibration loop so that figures of different machines can be compared. Prints one
// JSON document.
//
//   board_bench [SIMULATED_SECONDS]

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file/output_folder.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/reader.h"

namespace {

using namespace koboshi;
using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// A million dependent steps of a 64-bit linear congruential generator: the latency of multiply and add.
double calibration_us() {
  std::vector<double> times_us;
  for (int repeat = 0; repeat < 11; ++repeat) {
    const auto start = Clock::now();
    std::uint64_t x = 1;
    for (int i = 0; i < 1'000'000; ++i) {
      x = x * 6364136223846793005u + 1442695040888963407u;
      asm volatile("" : "+r"(x));
    }
    times_us.push_back(microseconds_since(start));
  }
  return median(std::move(times_us));
}

double beside_physics_s(const sim_board::TimeShares& shares) {
  return shares.bus_s + shares.drives_s + shares.firmware_s + shares.sensors_s;
}

struct Costs {
  std::vector<double> beside_physics_us;  // by tick
  std::vector<double> recording_us;
  double wall_s = 0.0;
};

Costs measure(double simulated_s, const std::filesystem::path& folder) {
  simulation::Scenario scenario = simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml");
  scenario.duration_us = static_cast<std::uint64_t>(1e6 * simulated_s);
  simulation::Simulation simulation(scenario);
  const OutputFolder out(folder);
  simulation::Recorder files(folder, simulation::RunRecorder::columns(simulation.robot()),
                             simulation::WhenFull::kWait);
  simulation::RunRecorder recorder(simulation, &files);
  Costs costs;
  const auto start = Clock::now();
  double before_s = 0.0;
  while (!simulation.finished()) {
    simulation.advance();
    if (simulation.board().now_us() % sim_board::SimBoard::kTick_us != 0) continue;
    const double now_s = beside_physics_s(simulation.board().time_shares());
    costs.beside_physics_us.push_back(1e6 * (now_s - before_s));
    before_s = now_s;
    const auto recording = Clock::now();
    recorder.record_tick();
    costs.recording_us.push_back(microseconds_since(recording));
  }
  costs.wall_s = 1e-6 * microseconds_since(start);
  files.close();
  return costs;
}

}  // namespace

int main(int argc, char** argv) {
  const double simulated_s = argc > 1 ? std::atof(argv[1]) : 20.0;
  const auto folder = std::filesystem::temp_directory_path() / "koboshi_board_bench";
  const double before_us = calibration_us();
  const Costs costs = measure(simulated_s, folder);
  const double after_us = calibration_us();
  std::filesystem::remove_all(folder);
  std::vector<double> total_us;
  for (std::size_t i = 0; i < costs.beside_physics_us.size(); ++i) {
    total_us.push_back(costs.beside_physics_us[i] + costs.recording_us[i]);
  }
  fmt::print(
      "{{\n  \"tick_beside_physics_us_median\": {:.1f},\n  \"of_it_recording_us_median\": {:.1f},\n"
      "  \"calibration_us\": {:.1f},\n  \"ratio_to_calibration\": {:.4f},\n  \"real_time_factor\": "
      "{:.2f}\n}}\n",
      median(total_us), median(costs.recording_us), 0.5 * (before_us + after_us),
      median(total_us) / (0.5 * (before_us + after_us)), simulated_s / costs.wall_s);
}
