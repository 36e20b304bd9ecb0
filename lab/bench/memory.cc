#include "lab/bench/memory.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "simulation/assembly/simulation.h"

namespace koboshi::lab {
namespace {

constexpr int kWorlds = 8;

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double total_pages = 0.0;
  double resident_pages = 0.0;
  file >> total_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::unique_ptr<simulation::Simulation> played(const simulation::Scenario& scenario) {
  auto simulation = std::make_unique<simulation::Simulation>(scenario);
  while (!simulation->finished()) simulation->advance();
  return simulation;
}

double growth_bytes(const simulation::Scenario& scenario) {
  std::vector<std::unique_ptr<simulation::Simulation>> simulations;
  simulations.push_back(played(scenario));
  const double before_bytes = resident_bytes();
  for (int i = 0; i < kWorlds; ++i) simulations.push_back(played(scenario));
  return (resident_bytes() - before_bytes) / kWorlds;
}

}  // namespace

double memory_of_world_bytes(const simulation::Scenario& scenario) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe for a measurement of memory");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process for a measurement of memory");
  if (child == 0) {
    int status = 1;
    try {
      const double bytes = growth_bytes(scenario);
      status = write(ends[1], &bytes, sizeof bytes) == sizeof bytes ? 0 : 1;
    } catch (const std::exception&) {
    }
    _exit(status);
  }
  close(ends[1]);
  double bytes = 0.0;
  const bool got = ::read(ends[0], &bytes, sizeof bytes) == sizeof bytes;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!got || status != 0) throw std::runtime_error("the measurement of memory failed");
  return bytes;
}

}  // namespace koboshi::lab
