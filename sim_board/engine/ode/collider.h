#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/height_field_contact.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/robot/description.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/link_tree.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// ODE's data of a contact.
struct Touch {
  dJointID joint;
  double depth_m;
  dSurfaceParameters surface;
};

// Detects contacts of the links' boxes with the ground and each other, and creates ODE's contact joints.
// Links with fewer than three joints between them are excluded: neighbours overlap at their hinge by design.
class Collider {
 public:
  // Links without a body have no boxes. The options must outlive the collider.
  Collider(dWorldID world, const RobotDescription& robot, const LinkTree& tree, const Bodies& bodies,
           const WorldOptions& options);

  // Replaces the contact joints by those for the bodies' present poses.
  void touch();
  // Reads the forces of the contact joints after the solver has run.
  void read_forces();
  std::span<const Contact> contacts() const { return contacts_; }
  // ODE's data of each contact, in the order of the contacts.
  std::span<const Touch> touches() const { return touches_; }
  // Sets the forces on the links for the contacts from `first` on, where held soles replaced the contact
  // joints.
  void set_forces(std::size_t first, std::span<const Eigen::Vector3d> forces_W);

  // Archives the contacts of the last step. Their joints are created anew in each step.
  void archive(StateArchive& archive) { archive(contacts_); }

 private:
  // Contact properties of a pair of shapes.
  struct Meeting {
    dSurfaceParameters surface;
    // First friction direction, if friction is anisotropic.
    Eigen::Vector3d direction;
    dGeomID direction_frame;  // null: the world
  };

  struct Pair {
    dGeomID geom;
    dGeomID other_geom;
    int link;
    int other_link;       // -1: the ground
    std::size_t meeting;  // index into meetings_
    bool is_plane;        // the meetings with its patches follow the one with the plane
  };

  struct Box {
    OdeGeom geom;
    int link;
    Eigen::Vector3d half_m;
    SurfaceDescription surface;
  };

  struct Field {
    HeightFieldContact contact;
    std::size_t first_meeting;  // by box, starting here
  };

  static std::vector<Box> make_boxes(const RobotDescription& robot, const Bodies& bodies);
  void make_ground();
  void make_pairs(const LinkTree& tree);
  void make_ground_pairs(const Box& box);
  void make_fields();
  // Each function appends to meetings_. `R_W` rotates the friction direction of the ground's surface to the
  // world.
  std::size_t meet_ground(const Box& box, const SurfaceDescription& ground, const Eigen::Matrix3d& R_W);
  std::size_t meet_box(const Box& box, const Box& other);
  void touch(const Pair& pair);
  void touch_fields();
  const Meeting& meeting_at(const Pair& pair, const dContactGeom& point) const;
  void add_contact(const dContactGeom& point, int link, int other_link, dBodyID body, dBodyID other_body,
                   const Meeting& meeting);

  dWorldID world_;
  const WorldOptions& options_;
  OdeJointGroup joints_;
  OdeGeom plane_;
  std::vector<OdeGeom> ground_boxes_;  // as in the options
  std::vector<Box> boxes_;
  std::vector<Pair> pairs_;
  std::vector<Field> fields_;  // as in the options
  std::vector<Meeting> meetings_;
  std::vector<Contact> contacts_;
  std::vector<Touch> touches_;
  std::vector<dJointFeedback> feedbacks_;  // by contact; must not move, because ODE writes into it
};

}  // namespace koboshi::sim
