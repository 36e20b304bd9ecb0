#include "sim_board/engine/ode/collider.h"

#include <array>

#include "sim_board/engine/ode/eigen.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim {
namespace {

// A box has eight corners; two boxes face to face touch in an octagon.
constexpr int kMaxContactsOfPair = 8;
// Neighbours, and neighbours of neighbours, overlap where their hinges cross.
constexpr int kLeastJointsBetween = 3;

dSurfaceParameters ode_surface(const SurfaceContact& surface) {
  dSurfaceParameters ode{};
  // Approx1: friction is bounded by mu times the present normal force, a pyramid instead of a cone.
  ode.mode = dContactApprox1 | dContactMu2 | dContactSoftERP | dContactSoftCFM | dContactBounce;
  ode.mu = surface.friction;
  ode.mu2 = surface.friction_second;
  ode.bounce = surface.bounce;
  ode.bounce_vel = surface.bounce_threshold_m_per_s;
  ode.soft_erp = surface.softness.error_reduction;
  ode.soft_cfm = surface.softness.constraint_force_mixing;
  return ode;
}

OdeGeom make_ground(const GroundDescription& ground) {
  const Eigen::Vector3d normal = ground.normal_W.normalized();
  return OdeGeom(dCreatePlane(nullptr, normal.x(), normal.y(), normal.z(), ground.offset_m));
}

bool apart(dGeomID geom, dGeomID other) {
  std::array<dReal, 6> a;  // min x, max x, min y, ...
  std::array<dReal, 6> b;
  dGeomGetAABB(geom, a.data());
  dGeomGetAABB(other, b.data());
  return a[0] > b[1] || b[0] > a[1] || a[2] > b[3] || b[2] > a[3] || a[4] > b[5] || b[4] > a[5];
}

}  // namespace

Collider::Collider(dWorldID world, const RobotDescription& robot, const LinkTree& tree, const Bodies& bodies,
                   const WorldOptions& options)
    : world_(world), joints_(dJointGroupCreate(0)), boxes_(make_boxes(robot, bodies)) {
  if (options.ground.present) ground_ = make_ground(options.ground);
  make_pairs(tree, options);
  contacts_.reserve(pairs_.size() * kMaxContactsOfPair);
  touches_.reserve(pairs_.size() * kMaxContactsOfPair);
  feedbacks_.resize(pairs_.size() * kMaxContactsOfPair);
}

std::vector<Collider::Box> Collider::make_boxes(const RobotDescription& robot, const Bodies& bodies) {
  std::vector<Box> boxes;
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    const LinkDescription& link = robot.links[l];
    for (const BoxDescription& box : link.collisions) {
      OdeGeom geom(dCreateBox(nullptr, box.size_m.x(), box.size_m.y(), box.size_m.z()));
      dGeomSetBody(geom.get(), bodies.of(static_cast<int>(l)));
      const Eigen::Vector3d p_ComG = box.X_LG.translation() - bodies.p_LCom_L(static_cast<int>(l));
      dGeomSetOffsetPosition(geom.get(), p_ComG.x(), p_ComG.y(), p_ComG.z());
      dMatrix3 R;
      copy_rotation(box.X_LG.linear(), R);
      dGeomSetOffsetRotation(geom.get(), R);
      boxes.push_back({std::move(geom), static_cast<int>(l), box.surface});
    }
  }
  return boxes;
}

void Collider::make_pairs(const LinkTree& tree, const WorldOptions& options) {
  for (auto box = boxes_.begin(); box != boxes_.end(); ++box) {
    if (ground_)
      pairs_.push_back({box->geom.get(), ground_.get(), box->link, -1,
                        ode_surface(meet(box->surface, options.ground.surface, options.step_s))});
    for (auto other = box + 1; other != boxes_.end(); ++other)
      if (tree.distance(box->link, other->link) >= kLeastJointsBetween)
        pairs_.push_back({box->geom.get(), other->geom.get(), box->link, other->link,
                          ode_surface(meet(box->surface, other->surface, options.step_s))});
  }
}

void Collider::touch() {
  dJointGroupEmpty(joints_.get());
  contacts_.clear();
  touches_.clear();
  for (const Pair& pair : pairs_)
    if (pair.other_link < 0 || !apart(pair.geom, pair.other_geom)) touch(pair);
}

void Collider::touch(const Pair& pair) {
  std::array<dContactGeom, kMaxContactsOfPair> points;
  const int count =
      dCollide(pair.geom, pair.other_geom, kMaxContactsOfPair, points.data(), sizeof(dContactGeom));
  for (int i = 0; i < count; ++i) {
    dContact contact{};
    contact.surface = pair.surface;
    contact.geom = points[static_cast<std::size_t>(i)];
    const dJointID joint = dJointCreateContact(world_, joints_.get(), &contact);
    dJointAttach(joint, dGeomGetBody(pair.geom), dGeomGetBody(pair.other_geom));
    dJointSetFeedback(joint, &feedbacks_[contacts_.size()]);
    touches_.push_back({joint, contact.geom.depth, contact.surface});
    contacts_.push_back({pair.link, pair.other_link, vector_of(contact.geom.pos),
                         vector_of(contact.geom.normal), Eigen::Vector3d::Zero()});
  }
}

void Collider::read_forces() {
  for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_[i].f_W = vector_of(feedbacks_[i].f1);
}

void Collider::set_forces(std::size_t first, std::span<const Eigen::Vector3d> forces_W) {
  for (std::size_t i = 0; i < forces_W.size(); ++i) contacts_[first + i].f_W = forces_W[i];
}

}  // namespace koboshi::sim
