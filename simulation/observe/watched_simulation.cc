#include "simulation/observe/watched_simulation.h"

#include <utility>

namespace koboshi::simulation {

WatchedSimulation::WatchedSimulation(const sim::Scenario& scenario, const HostFactory& make_host)
    : simulation_(scenario, make_host), recorder_(simulation_, nullptr, this) {}

void WatchedSimulation::step(std::size_t milliseconds) {
  for (std::size_t i = 0; i < milliseconds; ++i) {
    simulation_.advance();
    recorder_.record();
  }
}

std::vector<BusFrame> WatchedSimulation::take_frames() { return std::exchange(frames_, {}); }

void WatchedSimulation::on_bus_frame(const hal::CanFrame& frame, std::uint64_t, std::uint64_t end_us) {
  if (keeps_frames_) frames_.push_back({end_us, frame});
}

}  // namespace koboshi::simulation
