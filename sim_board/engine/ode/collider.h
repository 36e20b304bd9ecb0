#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/robot/description.h"
#include "sim_board/world/link_tree.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// What ODE knows of a contact.
struct Touch {
  dJointID joint;
  double depth_m;
  dSurfaceParameters surface;
};

// Finds where the boxes of the links touch the ground and each other, and makes ODE's contact joints of it.
// Links that fewer than three joints part never touch: neighbours overlap at their hinge by construction.
class Collider {
 public:
  // Links without a body of their own have no boxes.
  Collider(dWorldID world, const RobotDescription& robot, const LinkTree& tree, const Bodies& bodies,
           const WorldOptions& options);

  // Replaces the contact joints by those of the bodies' present poses.
  void touch();
  // After the solver: reads the forces of the joints that the last touch() made.
  void read_forces();
  std::span<const Contact> contacts() const { return contacts_; }
  // Beside each contact.
  std::span<const Touch> touches() const { return touches_; }
  // Where others than the contact joints held: what the links feel at the contacts from `first` on.
  void set_forces(std::size_t first, std::span<const Eigen::Vector3d> forces_W);

 private:
  struct Pair {
    dGeomID geom;
    dGeomID other_geom;
    int link;
    int other_link;  // -1: the ground
    dSurfaceParameters surface;
  };

  struct Box {
    OdeGeom geom;
    int link;
    SurfaceDescription surface;
  };

  static std::vector<Box> make_boxes(const RobotDescription& robot, const Bodies& bodies);
  void make_pairs(const LinkTree& tree, const WorldOptions& options);
  void touch(const Pair& pair);

  dWorldID world_;
  OdeJointGroup joints_;
  OdeGeom ground_;
  std::vector<Box> boxes_;
  std::vector<Pair> pairs_;
  std::vector<Contact> contacts_;
  std::vector<Touch> touches_;
  std::vector<dJointFeedback> feedbacks_;  // by contact; ODE writes into it, so it never moves
};

}  // namespace koboshi::sim
