#include "sim_board/engine/ode/ode_world.h"

#include <ode/ode.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "sim_board/engine/ode/collider.h"
#include "sim_board/engine/ode/eigen.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/engine/ode/saved_bodies.h"
#include "sim_board/engine/ode/servo_joint.h"
#include "sim_board/world/link_tree.h"

namespace koboshi::sim {
namespace {

// No push or torque of a real scenario comes near; far beyond it ODE's own arithmetic overflows inside a
// step.
constexpr double kLargestForce = 1e6;  // N or N m

// Then the solver decides. Squats need a second guess in 1 % of the steps, falls in 11 %.
constexpr int kMostGuesses = 4;

dMass ode_mass(const LinkDescription& link) {
  const Eigen::Matrix3d& I = link.I_LCom_L;
  if (!(link.mass_kg > 0.0) || I.llt().info() != Eigen::Success)
    throw std::invalid_argument("link '" + link.name + "' has no positive mass and inertia");
  dMass mass;
  dMassSetParameters(&mass, link.mass_kg, 0.0, 0.0, 0.0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2),
                     I(1, 2));
  return mass;
}

Eigen::Isometry3d centre_of_mass_frame(const Eigen::Isometry3d& X_WL, const LinkDescription& link) {
  return X_WL * Eigen::Translation3d(link.p_LCom_L);
}

template <typename List>
auto& at(List& list, int index) {
  return list.at(static_cast<std::size_t>(index));
}

class OdeWorld final : public World {
 public:
  OdeWorld(const RobotDescription& robot, const WorldOptions& options);

  void set_servo(int joint, const ServoTorque& torque) override { at(joints_, joint).set_servo(torque); }
  void push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) override;
  void release_base() override;
  void step() override;

  double step_s() const override { return options_.step_s; }
  double time_s() const override { return static_cast<double>(steps_) * options_.step_s; }
  JointState joint(int joint) const override { return at(joints_, joint).state(); }
  BodyState body(int link) const override;
  Wrench joint_wrench(int joint) const override { return at(joints_, joint).wrench(); }
  std::span<const Contact> contacts() const override { return collider_->contacts(); }
  std::uint64_t solver_warnings() const override { return solver_warnings_; }

 private:
  void make_world();
  void make_bodies();
  void make_joints();
  bool solve_guessing_friction();
  void solve_bounding_friction();
  void pose_bodies(const std::vector<Eigen::Isometry3d>& X_WLs);
  void check_inputs() const;
  void check_bodies() const;
  [[noreturn]] void blow_up(const std::string& what, const std::string& reason) const;

  const RobotDescription robot_;
  const WorldOptions options_;
  std::uint64_t steps_ = 0;
  std::uint64_t solver_warnings_ = 0;
  unsigned long quick_seed_ = 0;
  SavedBodies saved_;
  OdeThreading threading_;
  OdeWorldHandle world_;
  std::vector<OdeBody> bodies_;
  std::vector<ServoJoint> joints_;
  std::unique_ptr<Collider> collider_;
};

OdeWorld::OdeWorld(const RobotDescription& robot, const WorldOptions& options)
    : robot_(robot), options_(checked(options, robot)) {
  const LinkTree tree(robot_);
  start_ode_in_this_thread();
  make_world();
  make_bodies();
  make_joints();
  saved_.resize(bodies_.size());
  pose_bodies(tree.poses(robot_, options_.X_WB, options_.joint_positions_rad));
  collider_ = std::make_unique<Collider>(world_.get(), robot_, tree, bodies_, options_);
}

void OdeWorld::make_world() {
  world_.reset(dWorldCreate());
  // Without an implementation of its own a world shares the process' one, which knows no locks.
  threading_.reset(dThreadingAllocateSelfThreadedImplementation());
  dWorldSetStepThreadingImplementation(world_.get(), dThreadingImplementationGetFunctions(threading_.get()),
                                       threading_.get());
  const Eigen::Vector3d& g = options_.gravity_W_m_per_s2;
  dWorldSetGravity(world_.get(), g.x(), g.y(), g.z());
  dWorldSetAutoDisableFlag(world_.get(), 0);
  dWorldSetQuickStepNumIterations(world_.get(), options_.quick_iterations);
}

void OdeWorld::make_bodies() {
  for (const LinkDescription& link : robot_.links) {
    bodies_.emplace_back(dBodyCreate(world_.get()));
    const dMass mass = ode_mass(link);
    dBodySetMass(bodies_.back().get(), &mass);
    set_pose(bodies_.back().get(), centre_of_mass_frame(link.X_ML, link));
  }
  if (options_.fixed_base) dBodySetKinematic(bodies_.front().get());
}

void OdeWorld::make_joints() {
  joints_.reserve(robot_.joints.size());
  for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
    const JointDescription& joint = robot_.joints[j];
    joints_.emplace_back(world_.get(), joint, at(bodies_, joint.child).get(), at(bodies_, joint.parent).get(),
                         options_.joint_positions_rad[j], options_.step_s);
  }
}

void OdeWorld::pose_bodies(const std::vector<Eigen::Isometry3d>& X_WLs) {
  for (std::size_t l = 0; l < bodies_.size(); ++l)
    set_pose(bodies_[l].get(), centre_of_mass_frame(X_WLs[l], robot_.links[l]));
}

void OdeWorld::push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) {
  if (!(f_W.cwiseAbs().maxCoeff() <= kLargestForce) || !p_L.allFinite())
    blow_up("body '" + at(robot_.links, link).name + "'", "a push that is not finite or beyond 1e6 N");
  const Eigen::Vector3d p_W = body(link).X_WL * p_L;
  dBodyAddForceAtPos(at(bodies_, link).get(), f_W.x(), f_W.y(), f_W.z(), p_W.x(), p_W.y(), p_W.z());
}

void OdeWorld::release_base() {
  if (dBodyIsKinematic(bodies_.front().get()) != 0) dBodySetDynamic(bodies_.front().get());
}

void OdeWorld::step() {
  start_ode_in_this_thread();
  check_inputs();
  for (ServoJoint& joint : joints_) joint.begin_step();
  {
    const OdeWarningCount count(solver_warnings_);
    collider_->touch();
    if (!solve_guessing_friction()) solve_bounding_friction();
  }
  ++steps_;
  for (ServoJoint& joint : joints_) joint.read_state();
  collider_->read_forces();
  check_bodies();
}

bool OdeWorld::solve_guessing_friction() {
  if (options_.stepper == Stepper::kQuick || options_.friction == FrictionMethod::kRows) return false;
  saved_.save(bodies_);
  for (int guess = 0; guess < kMostGuesses; ++guess) {
    for (ServoJoint& joint : joints_) joint.guess_friction();
    dWorldStep(world_.get(), options_.step_s);
    bool confirmed = true;
    for (ServoJoint& joint : joints_) confirmed = joint.confirm_friction() && confirmed;
    if (confirmed) return true;
    saved_.restore(bodies_);
  }
  return false;
}

void OdeWorld::solve_bounding_friction() {
  for (ServoJoint& joint : joints_) joint.bound_friction();
  if (options_.stepper == Stepper::kQuick) {
    quick_step(world_.get(), options_.step_s, quick_seed_);
  } else {
    dWorldStep(world_.get(), options_.step_s);
  }
}

BodyState OdeWorld::body(int link) const {
  const dBodyID body = at(bodies_, link).get();
  return {pose_of(body) * Eigen::Translation3d(-at(robot_.links, link).p_LCom_L),
          vector_of(dBodyGetLinearVel(body)), vector_of(dBodyGetAngularVel(body))};
}

void OdeWorld::check_inputs() const {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const ServoTorque& servo = joints_[j].servo();
    const bool sane = std::abs(servo.drive_Nm) <= kLargestForce && servo.damping_Nm_s >= 0.0 &&
                      servo.damping_Nm_s <= kLargestForce && servo.rotor_inertia_kg_m2 >= 0.0 &&
                      servo.rotor_inertia_kg_m2 <= kLargestForce && servo.friction_Nm >= 0.0 &&
                      servo.friction_Nm <= kLargestForce;
    if (!sane)
      blow_up("joint '" + robot_.joints[j].name + "'", "a servo torque that is not finite or beyond 1e6");
  }
}

void OdeWorld::check_bodies() const {
  for (std::size_t l = 0; l < bodies_.size(); ++l) {
    const dBodyID body = bodies_[l].get();
    const double speed_m_per_s = vector_of(dBodyGetLinearVel(body)).norm();
    const double rate_rad_per_s = vector_of(dBodyGetAngularVel(body)).norm();
    const bool finite = pose_of(body).matrix().allFinite();
    if (finite && speed_m_per_s <= options_.max_speed_m_per_s &&
        rate_rad_per_s <= options_.max_rate_rad_per_s)
      continue;
    blow_up("body '" + robot_.links[l].name + "'", finite ? "moves at " + std::to_string(speed_m_per_s) +
                                                                " m/s and " + std::to_string(rate_rad_per_s) +
                                                                " rad/s"
                                                          : "its pose is not finite");
  }
}

void OdeWorld::blow_up(const std::string& what, const std::string& reason) const {
  throw WorldBlewUp("the world blew up at " + std::to_string(time_s()) + " s: " + what + ": " + reason);
}

}  // namespace

std::unique_ptr<World> make_ode_world(const RobotDescription& robot, const WorldOptions& options) {
  return std::make_unique<OdeWorld>(robot, options);
}

}  // namespace koboshi::sim
