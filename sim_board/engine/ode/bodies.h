#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "sim_board/engine/ode/hinge_chains.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/robot/description.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// ODE's bodies of the links. Each has its frame in its centre of mass and the axes of its link. A link
// between the hinges of a chain has none: its mass and inertia are added to those of the link that it rides
// on, as they are at joint zero.
class Bodies {
 public:
  // Throws std::invalid_argument for a link without positive mass and inertia. The bodies stand as at joint
  // zero, with the model frame in the world's.
  Bodies(dWorldID world, const RobotDescription& robot, std::span<const HingeChain> chains);

  bool has_own(int link) const { return at(link).rides_on < 0; }
  // The link's own body, or that of the link it rides on.
  dBodyID of(int link) const;
  // From the frame of a link with a body to the body's centre of mass.
  const Eigen::Vector3d& p_LCom_L(int link) const { return at(link).inertia.p_LCom_L; }
  void set_pose(int link, const Eigen::Isometry3d& X_WL);
  // Of a link with a body.
  BodyState state(const RobotDescription& robot, int link) const;

  std::span<const OdeBody> all() const { return bodies_; }
  // The link whose body is all()[index].
  int link_of(std::size_t index) const { return links_[index]; }

 private:
  struct Inertia {
    double mass_kg = 0.0;
    Eigen::Vector3d p_LCom_L = Eigen::Vector3d::Zero();
    Eigen::Matrix3d I_LCom_L = Eigen::Matrix3d::Zero();

    void add(const Inertia& other);
  };
  struct Entry {
    Inertia inertia;       // of the body, riders included
    int rides_on = -1;     // a link with a body; -1: has its own
    std::size_t body = 0;  // index into bodies_
  };

  const Entry& at(int link) const { return entries_[static_cast<std::size_t>(link)]; }
  Entry& at(int link) { return entries_[static_cast<std::size_t>(link)]; }
  void let_ride(const RobotDescription& robot, int link, int carrier);

  std::vector<Entry> entries_;  // by link
  std::vector<OdeBody> bodies_;
  std::vector<int> links_;  // by body
};

}  // namespace koboshi::sim
