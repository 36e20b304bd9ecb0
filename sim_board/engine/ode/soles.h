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

// Which links stand flat on the ground, as a guess before each solution. Theirs are held soles, and the
// contact joints are switched off; where that turns out impossible, or for all others, the contact joints do
// the work. A link that its contact joints have kept still is held in the next step.
class Soles {
 public:
  Soles(dWorldID world, const RobotDescription& robot, const Bodies& bodies, double step_s);

  // After Collider::touch.
  void guess(const Collider& collider);
  // Whether all that were held can be; those that cannot are let go, for another solution.
  bool confirm();
  void let_go();
  // After the solution is accepted and the collider has read its forces.
  void finish_step(Collider& collider);

  // Only guesses outlast a step: guess() holds each sole anew, or lets it go.
  void archive(StateArchive& archive) {
    for (Sole& sole : soles_) archive(sole.stands, sole.resting_steps);
  }

 private:
  struct Sole {
    HeldSole held;
    dBodyID body = nullptr;
    bool stands = false;    // the guess for the next step
    int resting_steps = 0;  // since it came to rest or was let go
    bool eligible = false;  // its contacts of this step could be held
    std::size_t first = 0;  // contacts of this step
    std::size_t count = 0;
    double friction = 0.0;  // the least of them
    std::vector<dJointID> joints;
  };

  void look_at(Sole& sole, const Collider& collider);
  void hold(Sole& sole, const Collider& collider);
  static void let_go(Sole& sole);
  bool rests(const Sole& sole, const Collider& collider) const;

  double step_s_;
  std::vector<Sole> soles_;        // by link with boxes
  std::vector<int> sole_of_link_;  // -1: none
  std::vector<SolePoint> points_;  // of one sole, to be used again
};

}  // namespace koboshi::sim
