#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/assembly/simulation.h"
#include "simulation/scenario/reader.h"
#include "tests/closed_loop/open_host.h"

namespace koboshi::test {

// A complete run in simulated time (firmware, board and scenario) that records all bus traffic.
class RobotRun final : private sim_board::BusObserver {
 public:
  struct Frame {
    hal::CanFrame frame;
    std::uint64_t start_us;
    std::uint64_t end_us;
  };

  explicit RobotRun(const simulation::Scenario& scenario);
  ~RobotRun() { board().electronics().bus().set_observer(nullptr); }

  void run_until_us(std::uint64_t end_us);
  // Returns false if the behaviour has not reached `state` at `limit_us`.
  bool run_until(behaviour::State state, std::uint64_t limit_us);
  bool run_until(const std::function<bool()>& condition, std::uint64_t limit_us);

  sim_board::SimBoard& board() { return simulation_.board(); }
  const sim_board::SimBoard& board() const { return simulation_.board(); }
  std::uint64_t now_us() const { return board().now_us(); }
  const decltype(app::ControllerValues::behaviour)& behaviour() const {
    return host_->controller().values().behaviour;
  }
  const app::ControllerValues& values() const { return host_->controller().values(); }
  const sim_board::RobotDescription& robot() const { return simulation_.robot(); }
  std::size_t joint(const std::string& name) const;
  // Number of drives that make torque.
  int torque_count() const;
  // Number of drives in this CiA 402 state.
  int count_in(canopen::cia402::State state) const;
  // Sum over all drives of the time for which a drive limited its demand. Zero for the robot's own motions:
  // the limits only reject implausible targets.
  std::uint64_t limited_ms() const;
  const std::vector<Frame>& frames() const { return frames_; }
  // Returns the emergency messages of this node with this error code.
  std::vector<Frame> emergencies(std::uint8_t node_id, std::uint16_t code) const;
  // Hash of all frames with their times and of the state of each body in each millisecond.
  std::uint64_t hash() const { return hash_; }

 private:
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;
  simulation::HostFactory remember_host();
  void hash_bodies();

  const OpenHost* host_ = nullptr;  // owned by the simulation, which sets it
  simulation::Simulation simulation_;
  std::vector<Frame> frames_;
  std::uint64_t hash_ = 0xCBF2'9CE4'8422'2325;  // FNV-1a
};

// The robot of scenarios/squat.yaml on its stand, with an earlier schedule: enabled at 0.7 s, released and
// standing from 1.4 s, squat commanded at 1.5 s. The robot begins to lower at 3.5 s and is at the bottom at
// 4.5 s.
inline constexpr std::uint64_t kEnable_us = 700'000;
inline constexpr std::uint64_t kRelease_us = 1'400'000;
inline constexpr std::uint64_t kPlay_us = 1'500'000;
inline constexpr std::uint64_t kMidSquat_us = 4'200'000;
simulation::Scenario quick_squat();
// The same run, but the robot stays on its stand.
simulation::Scenario hanging_squat();

// `quick_squat` or `hanging_squat` with an added fault.
simulation::Scenario with_fault(simulation::Scenario scenario, simulation::Fault::Kind kind,
                                std::uint64_t at_us, const std::string& joint = {});

}  // namespace koboshi::test
