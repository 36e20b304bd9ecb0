#include "simulation/observe/watched_simulation.h"

#include <utility>

namespace koboshi::simulation {

WatchedSimulation::WatchedSimulation(const Scenario& scenario, const HostFactory& make_host)
    : simulation_(scenario, make_host) {
  observe();
}

WatchedSimulation::WatchedSimulation(std::shared_ptr<const PreparedScenario> prepared, std::uint64_t seed)
    : simulation_(std::move(prepared), seed) {
  observe();
}

void WatchedSimulation::observe() {
  sim_board::BusObserver& frames = *this;
  recorder_.emplace(simulation_, nullptr, &frames);
}

void WatchedSimulation::step(std::size_t milliseconds) {
  for (std::size_t i = 0; i < milliseconds; ++i) {
    simulation_.advance();
    recorder_->record();
    if (keeps_rows_ && now_us() % sim_board::SimBoard::kTick_us == 0) keep_row();
  }
}

void WatchedSimulation::keep_row() {
  rows_.push_back(static_cast<double>(now_us()) / 1e6);  // rounded once, as in trace.csv
  for (const TraceValue& value : recorder_->row()) rows_.push_back(value.number());
}

void WatchedSimulation::keep_rows(bool keep) {
  keeps_rows_ = keep;
  rows_.clear();
  recorder_->make_rows(keep);
}

std::vector<double> WatchedSimulation::take_rows() { return std::exchange(rows_, {}); }

void WatchedSimulation::reset(std::uint64_t seed) {
  recorder_.reset();
  keeps_rows_ = false;
  rows_.clear();
  frames_.clear();
  simulation_.reset(seed);
  observe();
}

void WatchedSimulation::restore(const Snapshot& snapshot) {
  simulation_.restore(snapshot);
  frames_.clear();
}

std::vector<BusFrame> WatchedSimulation::take_frames() { return std::exchange(frames_, {}); }

void WatchedSimulation::on_bus_frame(const hal::CanFrame& frame, std::uint64_t, std::uint64_t end_us) {
  if (keeps_frames_) frames_.push_back({end_us, frame});
}

}  // namespace koboshi::simulation
