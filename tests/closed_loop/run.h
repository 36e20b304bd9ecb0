#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "sim_board/scenario/reader.h"
#include "simulation/scenario/simulation.h"
#include "tests/closed_loop/open_host.h"

namespace koboshi::test {

// A whole run in simulated time: firmware, board and scenario, with all that was said on the bus.
class RobotRun final : private sim::BusObserver {
 public:
  struct Frame {
    hal::CanFrame frame;
    std::uint64_t start_us;
    std::uint64_t end_us;
  };

  explicit RobotRun(const sim::Scenario& scenario);
  ~RobotRun() { board().bus().set_observer(nullptr); }

  void run_until_us(std::uint64_t end_us);
  // False when the state did not come until then.
  bool run_until(behaviour::State state, std::uint64_t limit_us);
  bool run_until(const std::function<bool()>& condition, std::uint64_t limit_us);

  sim::SimBoard& board() { return simulation_.board(); }
  const sim::SimBoard& board() const { return simulation_.board(); }
  std::uint64_t now_us() const { return board().now_us(); }
  const decltype(app::ControllerValues::behaviour)& behaviour() const {
    return host_->controller().values().behaviour;
  }
  const sim::RobotDescription& robot() const { return simulation_.robot(); }
  std::size_t joint(const std::string& name) const;
  // How many drives make torque.
  int torque_count() const;
  // How many are in this state.
  int count_in(canopen::cia402::State state) const;
  // How long drives have held back behind their targets, of all together: none of the robot's own motions
  // meets a limit that is there to catch nonsense.
  std::uint64_t limited_ms() const;
  const std::vector<Frame>& frames() const { return frames_; }
  // Emergency messages of a node that tell of this error.
  std::vector<Frame> emergencies(std::uint8_t node_id, std::uint16_t code) const;
  // Of all frames with their times, and of every body's state in each millisecond.
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

// The robot of scenarios/squat.yaml on its stand, quicker than there: enabled at 0.7 s, standing by itself
// from 1.4 s on, told to play the squat at 1.5 s. It begins to go down at 3.5 s and is down at 4.5 s.
inline constexpr std::uint64_t kEnable_us = 700'000;
inline constexpr std::uint64_t kRelease_us = 1'400'000;
inline constexpr std::uint64_t kPlay_us = 1'500'000;
inline constexpr std::uint64_t kMidSquat_us = 4'200'000;
sim::Scenario quick_squat();
// The same, but it stays on its stand.
sim::Scenario hanging_squat();

// `quick_squat` or `hanging_squat` with something that breaks.
sim::Scenario with_fault(sim::Scenario scenario, sim::Fault::Kind kind, std::uint64_t at_us,
                         const std::string& joint = {});

}  // namespace koboshi::test
