#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/collider.h"
#include "sim_board/engine/ode/held_sole.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim_board {

// Guesses before each solution which links rest flat on the ground. These become held soles, whose rows
// replace those of their contacts. A link whose contacts have kept it at rest for a while is held from then
// on, until the ground could not exert the forces.
class Soles {
 public:
  Soles(const RobotDescription& robot, const Bodies& bodies, double step_s);

  // Call it after Collider::find_contacts.
  void guess(const Collider& collider);
  void add_rows(std::vector<TreeRow>& rows, const Eigen::Vector3d& p_WO_W);
  // Returns whether a held sole replaces this link's contacts with the ground.
  bool holds(int link) const {
    const int sole = sole_of_link_[static_cast<std::size_t>(link)];
    return sole >= 0 && soles_[static_cast<std::size_t>(sole)].held.holds();
  }
  // Returns whether all held soles are possible. Releases those that are not, for another solution.
  bool confirm(const TreeSolver& solver);
  void let_go();
  // Call it after the solution is accepted and the collider has read its forces.
  void finish_step(Collider& collider);

  // Only the guesses persist between steps: guess() holds or releases each sole anew.
  void archive(StateArchive& archive);

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
  };

  void look_at(Sole& sole, const Collider& collider);
  void hold(Sole& sole, const Collider& collider);
  bool rests(const Sole& sole, const Collider& collider) const;

  double step_s_;
  std::vector<Sole> soles_;        // by link with boxes
  std::vector<int> sole_of_link_;  // -1: none
  std::vector<SolePoint> points_;  // of one sole; reused memory
};

}  // namespace koboshi::sim_board
