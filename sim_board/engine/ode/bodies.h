#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/engine/ode/hinge_chains.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// ODE bodies of the links. Each frame is at the link's centre of mass with its axes. A link between the
// hinges of a chain has no body. The tree's solver knows it where it is (TreeStep); for ODE, its mass is at
// the centre of mass of the link that carries it, with the moment of inertia of the pose at joint angles
// zero.
class Bodies {
 public:
  // Throws std::invalid_argument for a link without positive mass and inertia. The initial poses are those at
  // joint angles zero, with the model frame equal to the world frame.
  Bodies(dWorldID world, const RobotDescription& robot, std::span<const HingeChain> chains);

  bool has_own(int link) const { return at(link).rides_on < 0; }
  // Returns the link's own body, or that of the link that carries it.
  dBodyID of(int link) const { return bodies_[index_of(link)].get(); }
  // Index of that body in all(). The base's is 0.
  std::size_t index_of(int link) const;
  // Position of the centre of mass of a link with a body, in its frame.
  const Eigen::Vector3d& p_LCom_L(int link) const { return at(link).inertia.p_LCom_L; }
  void set_pose(int link, const Eigen::Isometry3d& X_WL);
  // State of a link with a body.
  BodyState state(int link) const;

  std::span<const OdeBody> all() const { return bodies_; }
  // Returns the link whose body is all()[index].
  int link_of(std::size_t index) const { return links_[index]; }

 private:
  struct Inertia {
    double mass_kg = 0.0;
    Eigen::Vector3d p_LCom_L = Eigen::Vector3d::Zero();
    Eigen::Matrix3d I_LCom_L = Eigen::Matrix3d::Zero();

    // Adds the inertia of a carried link; the centre of mass stays.
    void carry(const Inertia& other);
  };
  struct Entry {
    Inertia inertia;       // of the body, including carried links
    int rides_on = -1;     // a link with a body; -1: has its own body
    std::size_t body = 0;  // index into bodies_
  };

  const Entry& at(int link) const { return entries_[static_cast<std::size_t>(link)]; }
  Entry& at(int link) { return entries_[static_cast<std::size_t>(link)]; }
  void let_ride(const RobotDescription& robot, int link, int carrier);

  std::vector<Entry> entries_;  // by link
  std::vector<OdeBody> bodies_;
  std::vector<int> links_;  // by body
};

}  // namespace koboshi::sim_board
