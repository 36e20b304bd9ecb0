#include "sim_board/engine/free_bodies_world.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mechanics/axes.h"
#include "sim_board/engine/bodies/bounce_law.h"
#include "sim_board/engine/bodies/touching.h"
#include "sim_board/engine/common/limits.h"
#include "sim_board/engine/forwarding_world.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using BodyShape = FreeBodyDescription::Shape;

// Parts of a contact: at a hundredth of its time a bounce is exact to 0.01 %.
constexpr double kPartsOfContact = 100.0;
// Surfaces that meet more slowly are damped as if they met at this speed, so that bodies come to rest: a
// bounce of 0.13 mm.
constexpr double kRestingSpeed_m_per_s = 0.05;
// After so many contact times an impact is over, and the damping is that of a body at rest.
constexpr double kImpactTimes = 3.0;
// Stiffness of the tangential spring relative to the normal one: that of a sphere's effective mass at its
// rim, 2/7 of its mass, so that both periods agree.
constexpr double kTangentStiffness = 2.0 / 7.0;
constexpr double kTangentDamping = 0.5;  // of the critical one; by hand, a box stops trembling in two periods

// A body may touch the ground, a link's box or another body.
struct Touchable {
  Solid solid;
  int link = -1;                             // of the robot
  int body = -1;                             // free
  Isometry3d X_LG = Isometry3d::Identity();  // of a link's box
  double friction = 0.0;
  double bounce = 0.0;
};

// The memory of a touching point.
struct PointMemory {
  double met_m_per_s = 0.0;  // the highest speed of approach; 0: apart
  double age_s = 0.0;
  Vector3d slip_W = Vector3d::Zero();  // of the tangential spring, m
};

// The motion of a point's carrier.
struct CarrierMotion {
  Vector3d com_W = Vector3d::Zero();
  Vector3d v_W = Vector3d::Zero();  // of com_W
  Vector3d w_W = Vector3d::Zero();

  Vector3d at(const Vector3d& p_W) const { return v_W + w_W.cross(p_W - com_W); }
};

// The effect of a body on a link's box in a step.
struct LinkReaction {
  Vector3d impulse_W = Vector3d::Zero();  // on the link, N s
  Vector3d moment_L = Vector3d::Zero();  // sum of points in the link's frame times the size of their impulses
  double size_N_s = 0.0;
};

struct BodyLoad {
  Vector3d force_W = Vector3d::Zero();
  Vector3d torque_W = Vector3d::Zero();  // about the centre of mass
  double resistance_Nm = 0.0;            // bound of the rolling friction
};

Matrix3d rotation_by(const Vector3d& angle_rad) {
  const double size = angle_rad.norm();
  if (size < 1e-12) return Matrix3d::Identity();
  return Eigen::AngleAxisd(size, angle_rad / size).toRotationMatrix();
}

class FreeBodiesWorld final : public ForwardingWorld {
 public:
  FreeBodiesWorld(std::unique_ptr<World> world, const RobotDescription& robot, const WorldOptions& options);

  void step() override;
  std::span<const FreeBodyState> free_bodies() const override { return states_; }
  std::span<const int> links_at_free_bodies() const override { return touched_links_; }
  void archive(StateArchive& archive) override {
    ForwardingWorld::archive(archive);
    archive(states_, touches_, touched_links_, is_near_);
  }

 private:
  void add_ground();
  void add_links();
  void add_bodies();
  PointMemory* touches_of(std::size_t body, std::size_t other) {
    return touches_.data() + (body * others_.size() + other) * kMaxTouchingPoints;
  }
  void begin_step();
  bool may_touch(std::size_t body, const Touchable& other) const;
  void move_links(double elapsed_s);
  void solve_part(double part_s);
  void touch(std::size_t body, std::size_t other, double part_s);
  Vector3d force_W(std::size_t body, std::size_t number, const TouchingPoint& point, PointMemory& touch,
                   double part_s) const;
  double stiffness_N_per_m(std::size_t body, const Touchable& other) const;
  CarrierMotion motion_of(const Touchable& other) const;
  void resist(std::size_t body, double normal_N);
  void integrate(std::size_t body, double part_s);
  void push_links();

  const RobotDescription robot_;
  const WorldOptions options_;
  const std::vector<FreeBodyDescription> bodies_;
  std::vector<FreeBodyState> states_;
  std::vector<int> touched_links_;    // by body
  std::vector<PointMemory> touches_;  // by body, other and point
  std::vector<double> lambdas_;       // of the bounce law, by body and other
  int parts_ = 1;
  // The present step alone:
  std::vector<Touchable> others_;
  std::vector<bool> is_near_;                // by body and other
  std::vector<BodyState> links_;             // at its beginning
  std::vector<CarrierMotion> link_motions_;  // with the centre of mass at the present part
  std::vector<Isometry3d> X_WLs_;
  std::vector<LinkReaction> reactions_;  // by body and other
  std::vector<BodyLoad> loads_;          // by body
  TouchingPoints points_;
};

FreeBodiesWorld::FreeBodiesWorld(std::unique_ptr<World> world, const RobotDescription& robot,
                                 const WorldOptions& options)
    : ForwardingWorld(std::move(world)), robot_(robot), options_(options), bodies_(options.free_bodies) {
  check(bodies_);
  if (!options_.ground.patches.empty() || !options_.ground.height_fields.empty())
    throw std::invalid_argument(
        "free bodies beside patches or height fields; they lie on a plane and on boxes");
  double shortest_s = bodies_.front().contact_time_s;
  for (const FreeBodyDescription& body : bodies_) {
    states_.push_back({body.X_WF, body.v_WF_W, Vector3d::Zero()});
    shortest_s = std::min(shortest_s, body.contact_time_s);
  }
  parts_ = static_cast<int>(std::ceil(options_.step_s / shortest_s * kPartsOfContact - 1e-9));
  add_ground();
  add_links();
  add_bodies();
  for (const FreeBodyDescription& body : bodies_)
    for (const Touchable& other : others_)
      lambdas_.push_back(bounce_damping(std::max(body.bounce, other.bounce)));
  touched_links_.assign(bodies_.size(), -1);
  touches_.resize(bodies_.size() * others_.size() * kMaxTouchingPoints);
  is_near_.resize(bodies_.size() * others_.size());
  reactions_.resize(bodies_.size() * others_.size());
  loads_.resize(bodies_.size());
  links_.resize(robot_.links.size());
  link_motions_.resize(robot_.links.size());
  X_WLs_.resize(robot_.links.size());
}

void FreeBodiesWorld::add_ground() {
  const auto add = [this](const Solid& solid, const SurfaceDescription& surface) {
    others_.push_back({.solid = solid,
                       .friction = std::min(surface.friction, surface.friction_second),
                       .bounce = surface.bounce});
  };
  const GroundDescription& ground = options_.ground;
  if (ground.present) {
    const Vector3d n_W = ground.normal_W.normalized();
    Solid plane;
    plane.X_WG.linear() = mechanics::rotation_to_normal(n_W);
    plane.X_WG.translation() = ground.offset_m * n_W;
    add(plane, ground.surface);
  }
  for (const GroundBox& box : ground.boxes)
    add({.shape = Solid::Shape::kBox, .X_WG = box.X_WG, .half_m = 0.5 * box.size_m}, box.surface);
}

void FreeBodiesWorld::add_links() {
  for (std::size_t link = 0; link < robot_.links.size(); ++link) {
    for (const BoxDescription& box : robot_.links[link].collisions) {
      others_.push_back({.solid = {.shape = Solid::Shape::kBox, .half_m = 0.5 * box.size_m},
                         .link = static_cast<int>(link),
                         .X_LG = box.X_LG,
                         .friction = std::min(box.surface.friction, box.surface.friction_second),
                         .bounce = box.surface.bounce});
    }
  }
}

void FreeBodiesWorld::add_bodies() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const FreeBodyDescription& body = bodies_[i];
    const bool is_box = body.shape == BodyShape::kBox;
    others_.push_back({.solid = {.shape = is_box ? Solid::Shape::kBox : Solid::Shape::kSphere,
                                 .X_WG = body.X_WF,
                                 .half_m = 0.5 * body.size_m},
                       .body = static_cast<int>(i),
                       .friction = body.friction,
                       .bounce = body.bounce});
  }
}

void FreeBodiesWorld::step() {
  begin_step();
  const double part_s = options_.step_s / parts_;
  for (int part = 0; part < parts_; ++part) {
    move_links(part * part_s);
    solve_part(part_s);
  }
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const FreeBodyState& state = states_[i];
    if (!state.X_WF.matrix().allFinite() || !(state.v_WF_W.norm() <= options_.max_speed_m_per_s))
      blow_up(time_s(), "the free body '" + bodies_[i].name + "'", "its motion diverged");
  }
  push_links();
  ForwardingWorld::step();
}

// Finds what may touch in this step.
void FreeBodiesWorld::begin_step() {
  for (std::size_t link = 0; link < links_.size(); ++link) links_[link] = body(static_cast<int>(link));
  move_links(0.0);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    others_[others_.size() - bodies_.size() + b].solid.X_WG = states_[b].X_WF;
  std::fill(reactions_.begin(), reactions_.end(), LinkReaction{});
  std::fill(touched_links_.begin(), touched_links_.end(), -1);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t o = 0; o < others_.size(); ++o) {
      const bool is_near = may_touch(b, others_[o]);
      if (!is_near && is_near_[b * others_.size() + o])
        std::fill_n(touches_of(b, o), kMaxTouchingPoints, PointMemory{});
      is_near_[b * others_.size() + o] = is_near;
    }
  }
}

bool FreeBodiesWorld::may_touch(std::size_t body, const Touchable& other) const {
  if (other.body >= 0 && other.body <= static_cast<int>(body)) return false;  // each pair once, not itself
  if (other.solid.shape == Solid::Shape::kPlane) return true;
  const Solid& solid = others_[others_.size() - bodies_.size() + body].solid;
  // Twice the way at the present speeds leaves room for what a step changes.
  const CarrierMotion motion = motion_of(other);
  const double speed_m_per_s = states_[body].v_WF_W.norm() + motion.v_W.norm() +
                               motion.w_W.norm() * (other.solid.X_WG.translation() - motion.com_W).norm() +
                               options_.step_s * options_.gravity_W_m_per_s2.norm();
  return (states_[body].X_WF.translation() - other.solid.X_WG.translation()).norm() <
         solid.radius_m() + other.solid.radius_m() + 2.0 * options_.step_s * speed_m_per_s;
}

// Links go on as they moved at the beginning of the step.
void FreeBodiesWorld::move_links(double elapsed_s) {
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const BodyState& link = links_[l];
    const Vector3d com_W = link.X_WL * robot_.links[l].p_LCom_L;
    const Matrix3d R = rotation_by(elapsed_s * link.w_WL_W);
    link_motions_[l] = {com_W + elapsed_s * link.v_WCom_W, link.v_WCom_W, link.w_WL_W};
    X_WLs_[l].linear() = R * link.X_WL.linear();
    X_WLs_[l].translation() = link_motions_[l].com_W + R * (link.X_WL.translation() - com_W);
  }
  for (Touchable& other : others_)
    if (other.link >= 0) other.solid.X_WG = X_WLs_[static_cast<std::size_t>(other.link)] * other.X_LG;
}

void FreeBodiesWorld::solve_part(double part_s) {
  std::fill(loads_.begin(), loads_.end(), BodyLoad{});
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    for (std::size_t o = 0; o < others_.size(); ++o)
      if (is_near_[b * others_.size() + o]) touch(b, o, part_s);
  for (std::size_t b = 0; b < bodies_.size(); ++b) integrate(b, part_s);
}

void FreeBodiesWorld::touch(std::size_t body, std::size_t number, double part_s) {
  const Touchable& other = others_[number];
  find_touching_points(others_[others_.size() - bodies_.size() + body].solid, other.solid, points_);
  PointMemory* touches = touches_of(body, number);
  std::size_t next = 0;  // points come in the order of their numbers
  for (const TouchingPoint& point : points_) {
    for (; next < point.number; ++next) touches[next] = {};
    next = point.number + 1;
    const Vector3d f_W = force_W(body, number, point, touches[point.number], part_s);
    loads_[body].force_W += f_W;
    loads_[body].torque_W += (point.p_W - states_[body].X_WF.translation()).cross(f_W);
    resist(body, f_W.dot(point.n_W));
    if (other.body >= 0) {
      const auto partner = static_cast<std::size_t>(other.body);
      loads_[partner].force_W -= f_W;
      loads_[partner].torque_W -= (point.p_W - states_[partner].X_WF.translation()).cross(f_W);
      resist(partner, f_W.dot(point.n_W));
    }
    if (other.link < 0) continue;
    touched_links_[body] = other.link;
    LinkReaction& reaction = reactions_[body * others_.size() + number];
    const double size_N_s = part_s * f_W.norm();
    reaction.impulse_W -= part_s * f_W;
    reaction.moment_L += size_N_s * (X_WLs_[static_cast<std::size_t>(other.link)].inverse() * point.p_W);
    reaction.size_N_s += size_N_s;
  }
  for (; next < kMaxTouchingPoints; ++next) touches[next] = {};
}

// Returns the force on the body.
Vector3d FreeBodiesWorld::force_W(std::size_t body, std::size_t number, const TouchingPoint& point,
                                  PointMemory& touch, double part_s) const {
  const Touchable& other = others_[number];
  const FreeBodyDescription& description = bodies_[body];
  const CarrierMotion own{states_[body].X_WF.translation(), states_[body].v_WF_W, states_[body].w_WF_W};
  const Vector3d v_W = own.at(point.p_W) - motion_of(other).at(point.p_W);
  const double approach_m_per_s = -v_W.dot(point.n_W);
  touch.age_s += part_s;
  const bool is_over = touch.age_s > kImpactTimes * description.contact_time_s;
  touch.met_m_per_s = std::max({kRestingSpeed_m_per_s, approach_m_per_s, is_over ? 0.0 : touch.met_m_per_s});

  const double k = stiffness_N_per_m(body, other);
  const double lambda = lambdas_[body * others_.size() + number];
  const double normal_N =
      k * point.depth_m * std::max(0.0, 1.0 + lambda * approach_m_per_s / touch.met_m_per_s);

  const Vector3d slide_W = v_W + approach_m_per_s * point.n_W;
  touch.slip_W += part_s * slide_W;
  touch.slip_W -= touch.slip_W.dot(point.n_W) * point.n_W;
  const double k_t = kTangentStiffness * k;
  const double damping_N_s_per_m =
      2.0 * kTangentDamping * std::sqrt(k_t * kTangentStiffness * description.mass_kg);
  Vector3d friction_W = -k_t * touch.slip_W - damping_N_s_per_m * slide_W;
  const double most_N = std::min(description.friction, other.friction) * normal_N;
  const double size_N = friction_W.norm();
  if (size_N > most_N) {
    friction_W *= most_N / size_N;
    touch.slip_W = -friction_W / k_t;
  }
  return normal_N * point.n_W + friction_W;
}

double FreeBodiesWorld::stiffness_N_per_m(std::size_t body, const Touchable& other) const {
  const auto of = [](const FreeBodyDescription& description) {
    const double rate = std::numbers::pi / description.contact_time_s;
    return description.mass_kg * rate * rate;
  };
  const double own = of(bodies_[body]);
  if (other.body < 0) return own;
  const double second = of(bodies_[static_cast<std::size_t>(other.body)]);
  return own * second / (own + second);
}

CarrierMotion FreeBodiesWorld::motion_of(const Touchable& other) const {
  if (other.link >= 0) return link_motions_[static_cast<std::size_t>(other.link)];
  if (other.body < 0) return {};
  const FreeBodyState& state = states_[static_cast<std::size_t>(other.body)];
  return {state.X_WF.translation(), state.v_WF_W, state.w_WF_W};
}

void FreeBodiesWorld::resist(std::size_t body, double normal_N) {
  const FreeBodyDescription& description = bodies_[body];
  if (description.shape != BodyShape::kSphere) return;
  loads_[body].resistance_Nm += description.rolling_friction * normal_N * 0.5 * description.size_m.x();
}

// Semi-implicit Euler: the new velocity moves the body.
void FreeBodiesWorld::integrate(std::size_t body, double part_s) {
  FreeBodyState& state = states_[body];
  const BodyLoad& load = loads_[body];
  state.v_WF_W += part_s * (load.force_W / bodies_[body].mass_kg + options_.gravity_W_m_per_s2);
  const Matrix3d R = state.X_WF.linear();
  const Vector3d moments = bodies_[body].moments_kg_m2();
  const Vector3d w_F = R.transpose() * state.w_WF_W;
  const Vector3d torque_F = R.transpose() * load.torque_W - w_F.cross(moments.cwiseProduct(w_F));
  state.w_WF_W += part_s * (R * torque_F.cwiseQuotient(moments));
  // Rolling friction stops the rotation at most.
  const double slowing_rad_per_s = part_s * load.resistance_Nm / moments.x();
  const double rate_rad_per_s = state.w_WF_W.norm();
  if (slowing_rad_per_s > 0.0)
    state.w_WF_W *= std::max(0.0, 1.0 - slowing_rad_per_s / std::max(rate_rad_per_s, slowing_rad_per_s));
  state.X_WF.translation() += part_s * state.v_WF_W;
  state.X_WF.linear() =
      Eigen::Quaterniond(rotation_by(part_s * state.w_WF_W) * R).normalized().toRotationMatrix();
  others_[others_.size() - bodies_.size() + body].solid.X_WG = state.X_WF;
}

void FreeBodiesWorld::push_links() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t o = 0; o < others_.size(); ++o) {
      const LinkReaction& reaction = reactions_[b * others_.size() + o];
      if (reaction.size_N_s == 0.0) continue;
      push(others_[o].link, reaction.moment_L / reaction.size_N_s, reaction.impulse_W / options_.step_s);
    }
  }
}

}  // namespace

std::unique_ptr<World> add_free_bodies(std::unique_ptr<World> world, const RobotDescription& robot,
                                       const WorldOptions& options) {
  return std::make_unique<FreeBodiesWorld>(std::move(world), robot, options);
}

}  // namespace koboshi::sim_board
