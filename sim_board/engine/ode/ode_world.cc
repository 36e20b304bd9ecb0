#include "sim_board/engine/ode/ode_world.h"

#include <ode/ode.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>

#include "sim_board/description/hinge_tree.h"
#include "sim_board/engine/common/impact_search.h"
#include "sim_board/engine/common/limits.h"
#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/collider.h"
#include "sim_board/engine/ode/eigen.h"
#include "sim_board/engine/ode/hinge_chains.h"
#include "sim_board/engine/ode/joint_chain.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/engine/ode/saved_bodies.h"
#include "sim_board/engine/ode/soles.h"
#include "sim_board/engine/ode/tree_step.h"

namespace koboshi::sim_board {
namespace {

// Maximum number of friction guesses per step; then the solver decides. A squat needs 1.12 on average, a walk
// 1.17.
constexpr int kMaxGuesses = 4;

// Maximum number of solutions of ODE's per step; then the friction of the contacts remains as it is.
constexpr int kMaxOdeSolutions = 16;

template <typename List>
auto& at(List& list, int index) {
  return list.at(static_cast<std::size_t>(index));
}

class OdeWorld final : public World {
 public:
  OdeWorld(const RobotDescription& robot, const WorldOptions& options);

  void set_servo(int joint, const ServoTorque& torque) override {
    chain_of(joint).motor(at(places_, joint).hinge).set_servo(torque);
  }
  void push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) override;
  void release_base() override;
  void step() override;

  double step_s() const override { return options_.step_s; }
  double time_s() const override { return static_cast<double>(steps_) * options_.step_s; }
  JointState joint(int joint) const override {
    return chain_of(joint).motor(at(places_, joint).hinge).state();
  }
  BodyState body(int link) const override;
  Wrench joint_wrench(int joint) const override;
  std::span<const Contact> contacts() const override { return collider_->contacts(); }
  std::uint64_t solver_warnings() const override { return solver_warnings_; }
  std::uint64_t unsettled_steps() const override { return unsettled_steps_; }
  void archive(StateArchive& archive) override;

 private:
  using Place = TreeStep::Place;

  void make_world();
  void make_joints(std::span<const HingeChain> chains);
  std::vector<TreeStep::Coupling> make_couplings(const RobotDescription& robot) const;
  void step_with_ode();
  void solve_with_ode();
  bool settle_impacts_of_tree();
  void guess_with_tree();
  void write_ode_rows();
  void bound_friction();
  bool confirm_joints();
  bool step_as_tree();
  bool solve_tree();
  bool solve_tree_once() { return tree_->step.solve(chains_, *collider_, tree_->soles); }
  void pose_bodies(const std::vector<Eigen::Isometry3d>& X_WLs);
  JointChain& chain_of(int joint) { return chains_[at(places_, joint).chain]; }
  const JointChain& chain_of(int joint) const { return chains_[at(places_, joint).chain]; }
  void check_inputs() const;
  void check_bodies() const;

  const RobotDescription robot_;  // its followers are joints
  const WorldOptions options_;
  const bool is_coupled_;
  std::uint64_t steps_ = 0;
  std::uint64_t solver_warnings_ = 0;
  std::uint64_t unsettled_steps_ = 0;
  bool settled_ = true;  // this step's contacts obey the law of friction
  SavedBodies saved_;
  OdeThreading threading_;
  OdeWorldHandle world_;
  std::unique_ptr<Bodies> bodies_;
  std::vector<JointChain> chains_;
  std::vector<Place> places_;     // by joint
  std::vector<int> joint_above_;  // by link; the base has none
  std::unique_ptr<Collider> collider_;
  struct Tree {
    TreeStep step;
    Soles soles;

    void archive(StateArchive& archive) { archive(step, soles); }
  };
  // Solves the step (kLumped) or finds the guesses for ODE's solver (kWorld). Made after all the others.
  std::optional<Tree> tree_;
};

OdeWorld::OdeWorld(const RobotDescription& robot, const WorldOptions& options)
    : robot_(with_followers_as_joints(robot)),
      options_(with_follower_positions(checked(options, robot), robot)),
      is_coupled_(!robot.followers.empty()) {
  const mechanics::HingeTree tree = hinge_tree(robot_);
  const std::vector<HingeChain> chains =
      options_.stepper == Stepper::kLumped ? lumped_hinges(robot_, tree) : single_hinges(tree);
  start_ode_in_this_thread();
  make_world();
  bodies_ = std::make_unique<Bodies>(world_.get(), robot_, chains);
  make_joints(chains);
  saved_.resize(bodies_->all().size());
  pose_bodies(tree.poses(options_.X_WB, options_.joint_positions_rad));
  for (JointChain& chain : chains_) chain.place();
  if (options_.fixed_base) dBodySetKinematic(bodies_->of(0));
  collider_ = std::make_unique<Collider>(world_.get(), robot_, tree, *bodies_, options_);
  tree_.emplace(Tree{TreeStep(robot_, *bodies_, chains_, make_couplings(robot), options_.gravity_W_m_per_s2,
                              options_.step_s),
                     Soles(robot_, *bodies_, options_.step_s)});
}

void OdeWorld::make_world() {
  world_.reset(dWorldCreate());
  // Without an implementation of its own, a world shares the global one, which is not thread-safe.
  threading_.reset(dThreadingAllocateSelfThreadedImplementation());
  dWorldSetStepThreadingImplementation(world_.get(), dThreadingImplementationGetFunctions(threading_.get()),
                                       threading_.get());
  const Eigen::Vector3d& g = options_.gravity_W_m_per_s2;
  dWorldSetGravity(world_.get(), g.x(), g.y(), g.z());
  dWorldSetAutoDisableFlag(world_.get(), 0);
}

void OdeWorld::make_joints(std::span<const HingeChain> chains) {
  chains_.reserve(chains.size());
  places_.resize(robot_.joints.size());
  joint_above_.assign(robot_.links.size(), -1);
  for (std::size_t j = 0; j < robot_.joints.size(); ++j)
    at(joint_above_, robot_.joints[j].child) = static_cast<int>(j);
  for (const HingeChain& chain : chains) {
    for (std::size_t i = 0; i < chain.joints.size(); ++i) at(places_, chain.joints[i]) = {chains_.size(), i};
    chains_.emplace_back(world_.get(), robot_, chain, *bodies_, options_.joint_positions_rad,
                         options_.step_s);
  }
}

// The followers are the last joints.
std::vector<TreeStep::Coupling> OdeWorld::make_couplings(const RobotDescription& robot) const {
  std::vector<TreeStep::Coupling> couplings;
  for (const FollowerDescription& follower : robot.followers)
    couplings.push_back({.follower = places_.at(robot.joints.size() + couplings.size()),
                         .leader = at(places_, follower.leader),
                         .multiplier = follower.multiplier,
                         .offset_rad = follower.offset_rad});
  return couplings;
}

void OdeWorld::pose_bodies(const std::vector<Eigen::Isometry3d>& X_WLs) {
  for (std::size_t l = 0; l < X_WLs.size(); ++l) {
    const int link = static_cast<int>(l);
    if (bodies_->has_own(link)) bodies_->set_pose(link, X_WLs[l]);
  }
}

void OdeWorld::push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) {
  check_push(time_s(), at(robot_.links, link), p_L, f_W);
  const Eigen::Vector3d p_W = body(link).X_WL * p_L;
  dBodyAddForceAtPos(bodies_->of(link), f_W.x(), f_W.y(), f_W.z(), p_W.x(), p_W.y(), p_W.z());
}

void OdeWorld::release_base() {
  if (dBodyIsKinematic(bodies_->of(0)) != 0) dBodySetDynamic(bodies_->of(0));
}

void OdeWorld::step() {
  start_ode_in_this_thread();
  check_inputs();
  for (JointChain& chain : chains_) chain.begin_step();
  bool as_tree = false;
  {
    const OdeWarningCount count(solver_warnings_);
    collider_->find_contacts();
    // A joint of ODE connects two bodies, a coupling four: such a robot is the tree's in kWorld, too.
    const bool wants_tree = options_.stepper == Stepper::kLumped || is_coupled_;
    as_tree = wants_tree && step_as_tree();
    if (!wants_tree) step_with_ode();
  }
  if (!settled_) ++unsettled_steps_;
  collider_->drop_gaps();
  ++steps_;
  for (JointChain& chain : chains_) {
    chain.finish_step();
    if (!as_tree) chain.read_ode_joint();
  }
  check_bodies();
}

void OdeWorld::step_with_ode() {
  const bool has_impacts = collider_->has_impacts();
  if (has_impacts) saved_.save(bodies_->all());
  solve_with_ode();
  if (!has_impacts) return;
  const auto solve_again = [&](double share) {
    collider_->scale_impacts(share);
    saved_.restore(bodies_->all());
    solve_with_ode();
    return true;
  };
  std::ignore = settle_impacts(solve_again, [&] { return collider_->impact_work_J(); });
}

// Repeats the step until the guesses are confirmed: which joints stick, and the friction of the contacts.
void OdeWorld::solve_with_ode() {
  int guesses = options_.friction == FrictionMethod::kRows ? 0 : kMaxGuesses;
  if (guesses == 0) bound_friction();
  saved_.save(bodies_->all());
  if (options_.stepper == Stepper::kWorld) guess_with_tree();
  for (int solution = 1;; ++solution) {
    write_ode_rows();
    dWorldStep(world_.get(), options_.step_s);
    collider_->read_joint_forces();
    bool confirmed = collider_->improve_friction();
    if (guesses > 0 && !confirm_joints()) {
      confirmed = false;
      if (--guesses == 0) bound_friction();
    }
    settled_ = confirmed;
    if (confirmed || solution == kMaxOdeSolutions) return;
    saved_.restore(bodies_->all());
  }
}

// The tree's solver has the same equations and takes a small share of the time of ODE's.
void OdeWorld::guess_with_tree() {
  tree_->step.begin(chains_);
  bool confirmed = false;
  for (int guess = 0; guess < kMaxGuesses && !confirmed; ++guess) {
    if (!solve_tree_once()) return;
    confirmed = options_.friction == FrictionMethod::kRows || confirm_joints();
  }
  collider_->read_guesses(tree_->step.solver());
  saved_.restore(bodies_->all());
}

void OdeWorld::write_ode_rows() {
  for (JointChain& chain : chains_) chain.write_ode_rows();
  collider_->make_joints();
}

// Corrects the guesses that were wrong.
bool OdeWorld::confirm_joints() {
  bool confirmed = true;
  for (JointChain& chain : chains_) confirmed = chain.confirm_friction() && confirmed;
  return confirmed;
}

void OdeWorld::bound_friction() {
  for (JointChain& chain : chains_) chain.bound_friction();
}

// ODE's solver does the step if the tree's finds no solution within rounding. This counts as a warning.
// Coupled hinges are free in such a step, and the next ones correct them. Returns whether the tree's found
// one.
bool OdeWorld::step_as_tree() {
  if (options_.stepper == Stepper::kLumped) tree_->soles.guess(*collider_);
  tree_->step.begin(chains_);
  const bool solved = solve_tree() && settle_impacts_of_tree();
  if (solved) {
    settled_ = tree_->step.solver().settled();
    tree_->step.finish(chains_);
    collider_->read_row_forces(tree_->step.solver());
  } else {
    ++solver_warnings_;
    tree_->soles.let_go();
    step_with_ode();
  }
  tree_->soles.finish_step(*collider_);
  return solved;
}

bool OdeWorld::settle_impacts_of_tree() {
  if (!collider_->has_impacts()) return true;
  collider_->read_row_forces(tree_->step.solver());
  const auto solve_again = [&](double share) {
    collider_->scale_impacts(share);
    if (!solve_tree()) return false;
    collider_->read_row_forces(tree_->step.solver());
    return true;
  };
  return settle_impacts(solve_again, [&] { return collider_->impact_work_J(); });
}

bool OdeWorld::solve_tree() {
  const int guesses = options_.friction == FrictionMethod::kRows ? 0 : kMaxGuesses;
  for (int guess = 0; guess < guesses; ++guess) {
    if (!solve_tree_once()) return false;
    bool confirmed = tree_->soles.confirm(tree_->step.solver());
    confirmed = confirm_joints() && confirmed;
    if (confirmed) return true;
  }
  tree_->soles.let_go();
  bound_friction();
  return solve_tree_once();
}

BodyState OdeWorld::body(int link) const {
  if (bodies_->has_own(link)) return bodies_->state(link);
  const Place& place = at(places_, at(joint_above_, link));
  return chains_[place.chain].link_between(place.hinge);
}

Wrench OdeWorld::joint_wrench(int joint) const { return chain_of(joint).wrench(at(places_, joint).hinge); }

// ODE's joints have no state between steps: their parameters are written before each solution, and ODE's
// solver has no warm start.
void OdeWorld::archive(StateArchive& archive) {
  bool held = dBodyIsKinematic(bodies_->of(0)) != 0;
  if (archive.writes()) saved_.save(bodies_->all());
  archive(steps_, solver_warnings_, unsettled_steps_, held, saved_, chains_, collider_, tree_);
  if (archive.writes()) return;
  if (held) {
    dBodySetKinematic(bodies_->of(0));
  } else {
    release_base();
  }
  saved_.restore(bodies_->all());
  for (JointChain& chain : chains_) chain.place();
}

void OdeWorld::check_inputs() const {
  for (std::size_t j = 0; j < robot_.joints.size(); ++j)
    check_servo(time_s(), robot_.joints[j], chains_[places_[j].chain].motor(places_[j].hinge).servo());
}

void OdeWorld::check_bodies() const {
  for (std::size_t b = 0; b < bodies_->all().size(); ++b) {
    const dBodyID body = bodies_->all()[b].get();
    check_body(time_s(), at(robot_.links, bodies_->link_of(b)), options_, pose_of(body),
               vector_of(dBodyGetLinearVel(body)), vector_of(dBodyGetAngularVel(body)));
  }
}

}  // namespace

std::unique_ptr<World> make_ode_world(const RobotDescription& robot, const WorldOptions& options) {
  return std::make_unique<OdeWorld>(robot, options);
}

}  // namespace koboshi::sim_board
