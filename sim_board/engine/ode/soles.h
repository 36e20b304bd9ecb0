#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <vector>

#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/collider.h"
#include "sim_board/engine/ode/held_sole.h"
#include "sim_board/robot/description.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim {

// Guesses before each solution which links rest flat on the ground. These become held soles, and their
// contact joints are switched off. The contact joints handle all other links, and those for which the guess
// proves wrong. A link that its contact joints have kept at rest is held in the next step.
class Soles {
 public:
  Soles(dWorldID world, const RobotDescription& robot, const Bodies& bodies, double step_s);

  // Call it after Collider::touch.
  void guess(const Collider& collider);
  // Returns whether all held soles are possible. Releases those that are not, for another solution.
  bool confirm();
  void let_go();
  // Call it after the solution is accepted and the collider has read its forces.
  void finish_step(Collider& collider);

  // Only the guesses persist between steps: guess() holds or releases each sole anew.
  void archive(StateArchive& archive) {
    for (Sole& sole : soles_) archive(sole.stands, sole.resting_steps);
  }

 private:
  struct Sole {
    HeldSole held;
    dBodyID body = nullptr;
    bool stands = false;    // the guess for the next step
    int resting_steps = 0;  // since it came to rest or was released
    bool eligible = false;  // its contacts of this step can be held
    std::size_t first = 0;  // index of the first contact of this step
    std::size_t count = 0;
    double friction = 0.0;  // the lowest of its contacts
    std::vector<dJointID> joints;
  };

  void look_at(Sole& sole, const Collider& collider);
  void hold(Sole& sole, const Collider& collider);
  static void let_go(Sole& sole);
  bool rests(const Sole& sole, const Collider& collider) const;

  double step_s_;
  std::vector<Sole> soles_;        // by link with boxes
  std::vector<int> sole_of_link_;  // -1: none
  std::vector<SolePoint> points_;  // of one sole; reused memory
};

}  // namespace koboshi::sim
