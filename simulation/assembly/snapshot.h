#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim_board/state/archive.h"

namespace koboshi::simulation {

// An observer whose state is saved and restored with the simulation (Simulation::attach).
class Companion {
 public:
  // Saves or restores the state between two milliseconds. Throws sim_board::NotSaveable if that is
  // impossible.
  virtual void archive(sim_board::StateArchive& archive) = 0;

 protected:
  ~Companion() = default;
};

// State of a Simulation at one instant: firmware with flash, bus, drives, sensors, world, scenario player and
// companions. It owns its memory (360 KiB for Koboshi) and may outlive the Simulation.
class Snapshot {
 public:
  std::uint64_t time_us() const { return time_us_; }
  std::size_t size_bytes() const { return state_.size_bytes(); }

 private:
  friend class Simulation;
  // Identifies one Simulation by its address.
  struct Identity {};
  // Identifies one run of it, from reset to reset, by its address.
  struct Run {
    std::shared_ptr<const Identity> simulation;
  };

  Snapshot() = default;

  std::shared_ptr<const Run> run_;
  std::vector<const Companion*> companions_;
  std::uint64_t time_us_ = 0;
  sim_board::SavedState state_;
};

}  // namespace koboshi::simulation
