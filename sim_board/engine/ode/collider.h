#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "mechanics/hinge_tree.h"
#include "sim_board/description/description.h"
#include "sim_board/engine/common/friction.h"
#include "sim_board/engine/common/normal_row.h"
#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/height_field_contact.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/engine/ode/near_boxes.h"
#include "sim_board/engine/ode/touch.h"
#include "sim_board/engine/tree/tree_solver.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Detects contacts of the links' boxes with the ground and each other, and creates ODE's contact joints or
// rows of the tree's solver.
// Links with fewer than three joints between them are excluded: neighbours overlap at their hinge by design.
class Collider {
 public:
  // Links without a body have no boxes. The options must outlive the collider.
  Collider(dWorldID world, const RobotDescription& robot, const mechanics::HingeTree& tree,
           const Bodies& bodies, const WorldOptions& options);

  // Detects the contacts for the bodies' present poses: surfaces that touch, and those that are about to
  // (kReach_steps). The latter have a negative depth.
  void find_contacts();
  // Replaces ODE's contact joints by those of the present contacts and guesses of their friction.
  void make_joints();
  // Reads the forces of the contact joints after ODE's solver has run.
  void read_joint_forces();
  // Improves the guesses of friction by the forces and the bodies' velocities after ODE's solver has run.
  // Returns whether the solution obeys the law of friction.
  bool improve_friction();
  // Appends the rows of one contact: its normal, then one or two directions of friction. `p_WO_W` is the
  // origin of the tree's spatial vectors.
  void add_rows(std::size_t contact, TreeSolver& solver, const Bodies& bodies, const Eigen::Vector3d& p_WO_W);
  // Reads the guesses of friction that the tree's solver found. No sole may be held.
  void read_guesses(const TreeSolver& solver);
  // Reads the forces of these rows after the tree's solver has run.
  void read_row_forces(const TreeSolver& solver);
  std::span<const Contact> contacts() const { return contacts_; }
  // ODE's data of each contact, in the order of the contacts.
  std::span<const Touch> touches() const { return touches_; }
  // Sets the forces on the links for the contacts from `first` on, where held soles replaced the contact
  // joints.
  void set_forces(std::size_t first, std::span<const Eigen::Vector3d> forces_W);

  // Whether a contact of this step is an impact with restitution.
  bool has_impacts() const;
  // Energy in J that the impacts' forces add to the links in the present solution: force times mean velocity.
  double impact_work_J() const;
  // Scales the coefficients of restitution of this step's impacts.
  void scale_impacts(double share) { impact_share_ = share; }

  // Ends a step: removes the contacts of surfaces that did not meet in it. touches() is then no longer valid.
  void drop_gaps();

  // Archives the contacts of the last step. Their joints or rows are created anew in each step.
  void archive(StateArchive& archive);

 private:
  static constexpr std::size_t kGround = static_cast<std::size_t>(-1);

  // Contact properties of a pair of shapes.
  struct Meeting {
    dSurfaceParameters surface;
    SurfaceContact contact;
    // First friction direction, if friction is anisotropic.
    Eigen::Vector3d direction;
    dGeomID direction_frame;  // null: the world
  };

  struct Pair {
    dGeomID geom;
    dGeomID other_geom;
    std::size_t box;        // index into boxes_
    std::size_t other_box;  // kGround: the ground
    Bounds ground_bounds;   // of a box of the ground
    std::size_t meeting;    // index into meetings_
    bool is_plane;          // the meetings with its patches follow the one with the plane
  };

  struct Box {
    OdeGeom geom;
    int link;
    Eigen::Vector3d half_m;
    SurfaceDescription surface;
    double radius_m;  // of its farthest corner from the body's centre of mass
    double reach_m;   // in this step
    Bounds bounds;    // in this step
  };

  struct Field {
    HeightFieldContact contact;
    std::size_t first_meeting;  // by box, starting here
  };

  static std::vector<Box> make_boxes(const RobotDescription& robot, const Bodies& bodies);
  void make_ground();
  void make_pairs(const mechanics::HingeTree& tree);
  void make_ground_pairs(std::size_t number);
  void make_fields();
  // Each function appends to meetings_. `R_W` rotates the friction direction of the ground's surface to the
  // world.
  std::size_t collide_with_ground(const Box& box, const SurfaceDescription& ground,
                                  const Eigen::Matrix3d& R_W);
  std::size_t meet_box(const Box& box, const Box& other);
  void find_bounds();
  double target_m_per_s(const NormalRow& row) const {
    return row.is_impact ? impact_share_ * row.target_m_per_s : row.target_m_per_s;
  }
  bool may_meet(const Pair& pair) const;
  void find_contacts_of(const Pair& pair);
  bool is_above_plane(const Box& box) const;
  std::size_t touch_plane(const Box& box, std::span<dContactGeom> points);
  void find_contacts_with_fields();
  const Meeting& meeting_at(const Pair& pair, const dContactGeom& point) const;
  void add_contact(const dContactGeom& point, int link, int other_link, dBodyID body, dBodyID other_body,
                   const Meeting& meeting);
  FrictionGuess guess_friction(const Touch& touch, const Contact& contact) const;

  dWorldID world_;
  const WorldOptions& options_;
  OdeJointGroup joints_;
  OdeGeom plane_;
  Eigen::Vector3d plane_normal_W_;
  std::vector<OdeGeom> ground_boxes_;  // as in the options
  NearBoxes near_;
  std::vector<Box> boxes_;
  std::vector<Pair> pairs_;
  std::vector<Field> fields_;  // as in the options
  std::vector<Meeting> meetings_;
  double impact_share_ = 1.0;
  std::vector<Contact> contacts_;
  std::vector<Contact> last_contacts_;  // of the step before
  std::vector<Touch> touches_;
  std::vector<dJointFeedback>
      feedbacks_;  // by contact; does not move while there are joints, because ODE writes into it
};

}  // namespace koboshi::sim_board
