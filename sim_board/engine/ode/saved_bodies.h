#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim_board/engine/ode/library.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim_board {

// Saves what a step changes in the bodies: their motion and the accumulated forces. Restores the same bits.
class SavedBodies {
 public:
  // Allocates memory for this number of bodies; save and restore then allocate none.
  void resize(std::size_t bodies) { bodies_.resize(bodies); }
  void save(std::span<const OdeBody> bodies);
  void restore(std::span<const OdeBody> bodies) const;
  void archive(StateArchive& archive);

 private:
  struct Saved {
    std::array<dReal, 3> position;
    std::array<dReal, 4> quaternion;
    std::array<dReal, 12> rotation;  // ODE's matrix of the same rotation
    std::array<dReal, 3> velocity;
    std::array<dReal, 3> rate;
    std::array<dReal, 3> force;
    std::array<dReal, 3> torque;
  };

  std::vector<Saved> bodies_;
};

}  // namespace koboshi::sim_board
