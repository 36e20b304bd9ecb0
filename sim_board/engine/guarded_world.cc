#include "sim_board/engine/guarded_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/engine/forwarding_world.h"
#include "sim_board/world/ground_truth.h"

namespace koboshi::sim_board {
namespace {

constexpr double kCheck_s = 0.01;
constexpr std::size_t kMaxPushes = 64;
// Decay factor per check of the energy that the ground's springs may still return.
constexpr double kForget = 0.9;

// Returns the lowest stiffness in N/m that a contact point between a link and the ground can have.
double softest_spring_N_per_m(const RobotDescription& robot, const WorldOptions& options) {
  double softest = std::numeric_limits<double>::infinity();
  const auto compare_with = [&](const SurfaceDescription& ground) {
    for (const LinkDescription& link : robot.links) {
      for (const BoxDescription& box : link.collisions) {
        const Softness soft =
            contact_between(box.surface, ground, options.step_s, options.material_pairs).softness;
        softest = std::min(softest, soft.error_reduction / (options.step_s * soft.constraint_force_mixing));
      }
    }
  };
  compare_with(options.ground.surface);
  for (const FrictionPatch& patch : options.ground.patches) compare_with(patch.surface);
  for (const GroundBox& box : options.ground.boxes) compare_with(box.surface);
  for (const HeightField& field : options.ground.height_fields) compare_with(field.surface);
  return softest;
}

class GuardedWorld final : public ForwardingWorld {
 public:
  GuardedWorld(std::unique_ptr<World> world, const RobotDescription& robot, const WorldOptions& options);

  void push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) override;
  void step() override;
  void archive(StateArchive& archive) override {
    ForwardingWorld::archive(archive);
    archive(steps_, speeds_rad_per_s_, pushes_, work_J_, lowest_J_, returnable_J_, energies_J_, strongest_);
  }

 private:
  struct Push {
    int link;
    Eigen::Vector3d p_L;
    Eigen::Vector3d f_W;
    double power_W;  // when the step begins
  };

  double power_W(const Push& push) const;
  void add_work();
  // The strongest contact of a link since the last check; force 0: none.
  struct Strongest {
    double force_N = 0.0;
    int other = -1;  // link; -1: the ground
  };

  double look_at_contacts();
  void note(int link, int other, double force_N);
  void check();
  std::string cause(int link) const;

  const RobotDescription robot_;
  const Eigen::Vector3d gravity_W_m_per_s2_;
  const double tolerance_J_;
  const double spring_N_per_m_;
  const int steps_a_check_;
  int steps_ = 0;
  std::vector<double> speeds_rad_per_s_;  // by joint, before the step
  std::vector<Push> pushes_;              // for the next step
  double work_J_ = 0.0;                   // input since the beginning
  double lowest_J_ = std::numeric_limits<double>::infinity();
  double returnable_J_ = 0.0;       // energy in the ground's springs now or shortly before
  std::vector<double> energies_J_;  // by link, at the last check
  std::vector<Strongest> strongest_;
};

GuardedWorld::GuardedWorld(std::unique_ptr<World> world, const RobotDescription& robot,
                           const WorldOptions& options)
    : ForwardingWorld(std::move(world)),
      robot_(robot),
      gravity_W_m_per_s2_(options.gravity_W_m_per_s2),
      tolerance_J_(options.energy_tolerance_J_per_kg * robot.total_mass_kg()),
      spring_N_per_m_(softest_spring_N_per_m(robot, options)),
      steps_a_check_(static_cast<int>(std::lround(kCheck_s / options.step_s))),
      speeds_rad_per_s_(robot.joints.size(), 0.0) {
  pushes_.reserve(kMaxPushes);
  energies_J_.resize(robot.links.size());
  strongest_.resize(robot.links.size());
  check();
}

double GuardedWorld::power_W(const Push& push) const {
  const BodyState state = body(push.link);
  const Eigen::Vector3d& p_LCom_L = robot_.links.at(static_cast<std::size_t>(push.link)).p_LCom_L;
  const Eigen::Vector3d v_WPoint_W =
      state.v_WCom_W + state.w_WL_W.cross(state.X_WL.linear() * (push.p_L - p_LCom_L));
  return push.f_W.dot(v_WPoint_W);
}

void GuardedWorld::push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) {
  ForwardingWorld::push(link, p_L, f_W);
  pushes_.push_back({link, p_L, f_W, 0.0});
  pushes_.back().power_W = power_W(pushes_.back());
}

void GuardedWorld::step() {
  ForwardingWorld::step();
  add_work();
  if (++steps_ % steps_a_check_ == 0) check();
}

void GuardedWorld::add_work() {
  const double half_s = 0.5 * step_s();
  for (std::size_t j = 0; j < speeds_rad_per_s_.size(); ++j) {
    const JointState state = joint(static_cast<int>(j));
    work_J_ += half_s * state.servo_Nm * (speeds_rad_per_s_[j] + state.speed_rad_per_s);
    speeds_rad_per_s_[j] = state.speed_rad_per_s;
  }
  returnable_J_ = std::max(returnable_J_, look_at_contacts());
  for (const Push& push : pushes_) work_J_ += half_s * (push.power_W + power_W(push));
  pushes_.clear();
}

// Energy of springs under these forces plus a quarter: the forces are those at the end of a step, lower than
// their maximum within it, and include the dampers. Also notes the forces, for the message.
double GuardedWorld::look_at_contacts() {
  double sum_N2 = 0.0;
  for (const Contact& contact : contacts()) {
    sum_N2 += std::pow(contact.f_W.dot(contact.n_W), 2);
    note(contact.link, contact.other_link, contact.f_W.norm());
    if (contact.other_link >= 0) note(contact.other_link, contact.link, contact.f_W.norm());
  }
  return 1.25 * sum_N2 / (2.0 * spring_N_per_m_);
}

void GuardedWorld::note(int link, int other, double force_N) {
  Strongest& strongest = strongest_[static_cast<std::size_t>(link)];
  if (force_N > strongest.force_N) strongest = {force_N, other};
}

void GuardedWorld::check() {
  double sum_J = 0.0;
  double largest_gain_J = -std::numeric_limits<double>::infinity();
  int gainer = 0;
  for (std::size_t l = 0; l < energies_J_.size(); ++l) {
    const double energy_J = link_energy_J(robot_, *this, static_cast<int>(l), gravity_W_m_per_s2_);
    if (energy_J - energies_J_[l] > largest_gain_J) {
      largest_gain_J = energy_J - energies_J_[l];
      gainer = static_cast<int>(l);
    }
    energies_J_[l] = energy_J;
    sum_J += energy_J;
  }
  const double unexplained_J = sum_J - work_J_;
  lowest_J_ = std::min(lowest_J_, unexplained_J);
  const double returned_J = std::min(unexplained_J - lowest_J_, returnable_J_);
  lowest_J_ += returned_J;
  returnable_J_ = kForget * (returnable_J_ - returned_J);
  const double gain_J = unexplained_J - lowest_J_;
  if (gain_J <= tolerance_J_) return strongest_.assign(strongest_.size(), {});
  throw WorldBlewUp("the world gained energy at " + std::to_string(time_s()) + " s: body '" +
                    robot_.links[static_cast<std::size_t>(gainer)].name + "': " + std::to_string(gain_J) +
                    " J more than the work of servos and pushes (tolerance " + std::to_string(tolerance_J_) +
                    " J); " + cause(gainer));
}

std::string GuardedWorld::cause(int link) const {
  const auto& [force_N, other] = strongest_[static_cast<std::size_t>(link)];
  if (force_N == 0.0) return "it has no contact, so its joints are the source";
  const std::string name =
      other < 0 ? "the ground" : "'" + robot_.links[static_cast<std::size_t>(other)].name + "'";
  return "its strongest contact in the last 10 ms: " + name + ", " + std::to_string(force_N) + " N";
}

}  // namespace

std::unique_ptr<World> guard_energy(std::unique_ptr<World> world, const RobotDescription& robot,
                                    const WorldOptions& options) {
  return std::make_unique<GuardedWorld>(std::move(world), robot, options);
}

}  // namespace koboshi::sim_board
