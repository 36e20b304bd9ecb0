#include "sim_board/engine/mujoco/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "sim_board/engine/common/impact_search.h"
#include "sim_board/engine/common/model_constants.h"
#include "sim_board/engine/common/normal_row.h"
#include "sim_board/engine/mujoco/constraint_row.h"
#include "sim_board/world/box_overlap.h"

namespace koboshi::sim_board {
namespace {

// A contact of less depth is never false: it can do no harm.
constexpr double kDepthTolerance_m = 0.0005;

using Eigen::Map;
using Eigen::Vector3d;

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

int named(const mjModel& model, mjtObj kind, const std::string& name) {
  return mj_name2id(&model, kind, name.c_str());
}

int geom_of(const mjModel& model, int box) { return named(model, mjOBJ_GEOM, geom_name(box)); }

// Returns the i-th vector of an array of vectors.
Map<const Vector3d> vector_at(const mjtNum* array, int i) { return Map<const Vector3d>(array + 3 * i); }

// Returns a contact's axes as columns: the normal from its first geom to its second, and two tangents.
Eigen::Matrix3d axes_of(const mjContact& contact) { return Map<const RowMajor3d>(contact.frame).transpose(); }

}  // namespace

Scene::Scene(const RobotDescription& robot, std::span<const FollowerDescription> followers,
             const std::vector<TouchingPair>& pairs, const WorldOptions& options, Base base) {
  start_mujoco();
  model_ = load_model(model_text(robot, followers, pairs, options, base));
  data_ = make_data(*model_);
  // The inverse inertia for which the softness of the rows was computed (constraint_row.h); the world body
  // has none.
  std::fill_n(model_->body_invweight0 + 2, 2 * (model_->nbody - 1), kInverseInertia);
  std::fill_n(model_->dof_invweight0, model_->nv, kInverseInertia);
  // MuJoCo would compute "simple" joints with the inertia at compile time and ignore changes of the armature.
  std::fill_n(model_->dof_simplenum, model_->nv, 0);
  find_numbers(robot);
  pairs_ = pairs;
  pair_of_geoms_.assign(index(model_->ngeom * model_->ngeom), -1);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int geom = geom_of(*model_, pairs[i].box);
    const int other = geom_of(*model_, pairs[i].other_box);
    pair_of_geoms_[index(geom * model_->ngeom + other)] = static_cast<int>(i);
    pair_of_geoms_[index(other * model_->ngeom + geom)] = static_cast<int>(i);
  }
  for (std::size_t j = 0; j < numbers_.size(); ++j)
    data_->qpos[numbers_[j].position] = options.joint_positions_rad[j];
  update_poses();
}

void Scene::find_numbers(const RobotDescription& robot) {
  for (std::size_t l = 0; l < robot.links.size(); ++l)
    bodies_.push_back(named(*model_, mjOBJ_BODY, "link" + std::to_string(l)));
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const int joint = named(*model_, mjOBJ_JOINT, "joint" + std::to_string(j));
    numbers_.push_back(
        {joint, model_->jnt_qposadr[joint], model_->jnt_dofadr[joint], body_of(robot.joints[j].child)});
  }
  sliding_Nm_.resize(numbers_.size());
  integrated_.resize(index(model_->nq));
  lift_m_per_s_.resize(index(model_->nconmax));
  is_impact_.resize(index(model_->nconmax));
  slip_m_per_s_.resize(index(model_->nconmax));
  row_acceleration_.resize(index(model_->njmax));
  links_.resize(index(model_->ngeom));
  for (int geom = 0; geom < model_->ngeom; ++geom) {
    const auto body = std::ranges::find(bodies_, model_->geom_bodyid[geom]);
    links_[index(geom)] = body == bodies_.end() ? -1 : static_cast<int>(body - bodies_.begin());
  }
}

void Scene::take_joints_from(const Scene& other) {
  for (std::size_t j = 0; j < numbers_.size(); ++j) {
    data_->qpos[numbers_[j].position] = other.data_->qpos[other.numbers_[j].position];
    data_->qvel[numbers_[j].speed] = other.data_->qvel[other.numbers_[j].speed];
    data_->qacc_warmstart[numbers_[j].speed] = other.data_->qacc_warmstart[other.numbers_[j].speed];
  }
  update_poses();
}

void Scene::set_servo(int joint, const ServoTorque& servo) {
  const int dof = numbers_[index(joint)].speed;
  const double speed = data_->qvel[dof];
  const bool slides = std::abs(speed) > kSlidingSpeed_rad_per_s;
  double& sliding_Nm = sliding_Nm_[index(joint)];
  sliding_Nm = slides ? -std::copysign(servo.friction_Nm, speed) : 0.0;
  model_->dof_armature[dof] = servo.rotor_inertia_kg_m2 + model_->opt.timestep * servo.damping_Nm_s;
  model_->dof_frictionloss[dof] = slides ? 0.0 : servo.friction_Nm;
  data_->qfrc_applied[dof] = servo.drive_Nm - servo.damping_Nm_s * speed + sliding_Nm;
}

void Scene::push(int link, const Vector3d& p_W, const Vector3d& f_W) {
  const int body = body_of(link);
  mjtNum* wrench = data_->xfrc_applied + 6 * body;  // at the centre of mass
  Map<Vector3d> force(wrench);
  Map<Vector3d> torque(wrench + 3);
  force += f_W;
  torque += (p_W - vector_at(data_->xipos, body)).cross(f_W);
}

// The stages of mj_step that this model needs: kinematics is computed at the end of a step, and there are no
// tendons, actuators or sensors.
void Scene::solve() {
  mj_crb(model_.get(), data_.get());
  mj_factorM(model_.get(), data_.get());
  mj_collision(model_.get(), data_.get());
  drop_false_contacts();
  drop_far_contacts();
  mj_makeConstraint(model_.get(), data_.get());
  mj_fwdVelocity(model_.get(), data_.get());
  mj_fwdAcceleration(model_.get(), data_.get());
  solve_contacts(1.0);
  const auto solve_again = [this](double share) {
    solve_contacts(share);
    return true;
  };
  std::ignore = settle_impacts(solve_again, [this] { return impact_work_J(); });
  if (!iteration_.settled()) ++unsettled_;
  mj_rnePostConstraint(model_.get(), data_.get());
  if (data_->solver_iter >= model_->opt.iterations) ++unconverged_;
}

// MuJoCo's box collider is made for boxes that overlap. Of boxes that are apart by less than their margin it
// sometimes reports an overlap: in a step in which they were 2.6 mm apart, contacts 11 and 29 mm deep. A
// contact is not much deeper than the least overlap of its boxes; twice that leaves MuJoCo its own choice of
// the axis.
void Scene::drop_false_contacts() {
  const auto pose_of = [&](int geom) {
    Eigen::Isometry3d X_WG = Eigen::Isometry3d::Identity();
    X_WG.linear() = Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data_->geom_xmat + 9 * geom);
    X_WG.translation() = vector_at(data_->geom_xpos, geom);
    return X_WG;
  };
  for (int i = 0; i < data_->ncon; ++i) {
    mjContact& contact = data_->contact[i];
    if (contact.includemargin <= 0.0 || -contact.dist <= kDepthTolerance_m) continue;
    const double overlap_m =
        box_overlap_m(pose_of(contact.geom1), vector_at(model_->geom_size, contact.geom1),
                      pose_of(contact.geom2), vector_at(model_->geom_size, contact.geom2));
    if (-contact.dist > 2.0 * overlap_m + kDepthTolerance_m) contact.exclude = 1;
  }
}

// The margins hold for the highest speeds. Of the contacts with a gap only those within the reach of these
// bodies in this step have rows (kReach_steps).
void Scene::drop_far_contacts() {
  const auto speed_m_per_s = [&](int geom) {
    std::array<mjtNum, 6> velocity{};  // of the geom's centre, angular part first
    mj_objectVelocity(model_.get(), data_.get(), mjOBJ_GEOM, geom, velocity.data(), 0);
    const bool is_ground = links_[index(geom)] < 0;  // a plane has no radius
    return vector_at(velocity.data(), 1).norm() +
           (is_ground ? 0.0 : model_->geom_rbound[geom] * vector_at(velocity.data(), 0).norm());
  };
  for (int i = 0; i < data_->ncon; ++i) {
    mjContact& contact = data_->contact[i];
    if (contact.dist <= 0.0) continue;
    const double reach_m =
        kReach_steps * model_->opt.timestep * (speed_m_per_s(contact.geom1) + speed_m_per_s(contact.geom2));
    if (contact.dist > reach_m) contact.exclude = 1;
  }
}

// MuJoCo has no restitution, and would repel surfaces from the margin on. The target of each contact's normal
// is that of its NormalRow, with ODE's row in MuJoCo's terms (constraint_row.h).
void Scene::aim_normals(double impact_share) {
  // Velocity that marks a point without a force: no impact makes a point as fast.
  constexpr double kOpen_m_per_s = -1e3;
  const double step_s = model_->opt.timestep;
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    if (contact.efc_address < 0) continue;
    const int pair = pair_of_geoms_[index(contact.geom1 * model_->ngeom + contact.geom2)];
    const SurfaceContact& surface = pairs_[index(pair)].surface;
    const double speed_m_per_s = data_->efc_vel[contact.efc_address];
    const std::optional<NormalRow> row = normal_row(surface, -contact.dist, -speed_m_per_s, step_s);
    is_impact_[index(i)] = row && row->is_impact;
    const double target_m_per_s =
        row ? row->target_m_per_s * (row->is_impact ? impact_share : 1.0) : kOpen_m_per_s;
    data_->efc_aref[contact.efc_address] = (target_m_per_s - speed_m_per_s) / step_s;
    if (row && row->is_impact) harden(contact);
  }
}

// Makes a contact as stiff as MuJoCo's contacts can be. Friction keeps its share of the stiffness.
void Scene::harden(const mjContact& contact) {
  const int moving = links_[index(contact.geom1)] < 0 || links_[index(contact.geom2)] < 0 ? 1 : 2;
  const mjtNum stiffest = moving * kInverseInertia * kMinRegularisation;
  const mjtNum share = std::min(1.0, stiffest / data_->efc_R[contact.efc_address]);
  for (int row = contact.efc_address; row < contact.efc_address + contact.dim; ++row) {
    data_->efc_R[row] *= share;
    data_->efc_D[row] /= share;
  }
}

void Scene::solve_contacts(double impact_share) {
  std::fill(is_impact_.begin(), is_impact_.end(), 0);
  aim_normals(impact_share);
  solve_sliding();
}

// Energy in J that the forces of impacts add: force times mean velocity.
double Scene::impact_work_J() const {
  const double step_s = model_->opt.timestep;
  double work_J = 0.0;
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    if (is_impact_[index(i)] == 0) continue;
    for (int row = contact.efc_address; row < contact.efc_address + contact.dim; ++row)
      work_J += step_s * data_->efc_force[row] *
                (data_->efc_vel[row] + 0.5 * step_s * row_acceleration_[index(row)]);
  }
  return work_J;
}

// Solves Coulomb's law: see LiftIteration.
void Scene::solve_sliding() {
  std::fill_n(row_acceleration_.begin(), data_->nefc, 0.0);
  std::fill(lift_m_per_s_.begin(), lift_m_per_s_.end(), 0.0);
  iteration_.begin(slips());
  lower_aims();
  mj_fwdConstraint(model_.get(), data_.get());
  mj_mulJacVec(model_.get(), data_.get(), row_acceleration_.data(), data_->qacc);
  while (!iteration_.is_over(slips())) {
    lower_aims();
    std::copy_n(data_->qacc, model_->nv, data_->qacc_warmstart);
    mj_fwdConstraint(model_.get(), data_.get());
    mj_mulJacVec(model_.get(), data_.get(), row_acceleration_.data(), data_->qacc);
  }
}

// Returns mu |v_t| of each contact at the end of the step, from its rows' accelerations.
std::span<const double> Scene::slips() {
  const double step_s = model_->opt.timestep;
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    const int row = contact.efc_address;
    const auto slip = [&](int tangent) {
      return contact.friction[tangent - 1] *
             (data_->efc_vel[row + tangent] + step_s * row_acceleration_[index(row + tangent)]);
    };
    slip_m_per_s_[index(i)] = row < 0 ? 0.0 : std::hypot(slip(1), slip(2));
  }
  return std::span(slip_m_per_s_).first(index(data_->ncon));
}

// Applies the iteration's lifts to the contacts' normal rows.
void Scene::lower_aims() {
  const std::span<const double> lifts = iteration_.lifts_m_per_s();
  for (int i = 0; i < data_->ncon; ++i) {
    const int row = data_->contact[i].efc_address;
    if (row < 0) continue;
    data_->efc_aref[row] -= (lifts[index(i)] - lift_m_per_s_[index(i)]) / model_->opt.timestep;
    lift_m_per_s_[index(i)] = lifts[index(i)];
  }
}

bool Scene::is_finite() const {
  return std::all_of(data_->qacc, data_->qacc + model_->nv, [](mjtNum a) { return std::isfinite(a); });
}

double Scene::servo_Nm(int joint, const ServoTorque& servo) const {
  const int dof = numbers_[index(joint)].speed;
  const double acceleration = data_->qacc[dof];
  const double new_speed = data_->qvel[dof] + model_->opt.timestep * acceleration;
  double friction_Nm = sliding_Nm_[index(joint)];
  for (int row = data_->ne; row < data_->ne + data_->nf; ++row)
    if (data_->efc_id[row] == dof) friction_Nm = data_->efc_force[row];
  return servo.drive_Nm - servo.damping_Nm_s * new_speed - servo.rotor_inertia_kg_m2 * acceleration +
         friction_Nm;
}

Wrench Scene::joint_wrench(int joint) const {
  const JointNumbers& numbers = numbers_[index(joint)];
  // Wrench of the parent on the child, torque first, about the centre of mass of the whole tree.
  const Vector3d p_WCom_W = vector_at(data_->subtree_com, model_->body_rootid[numbers.child]);
  const Vector3d torque_Nm = vector_at(data_->cfrc_int, 2 * numbers.child);
  const Vector3d force_N = vector_at(data_->cfrc_int, 2 * numbers.child + 1);
  const Vector3d p_AnchorCom_W = p_WCom_W - vector_at(data_->xanchor, numbers.joint);
  return {-force_N, -torque_Nm - p_AnchorCom_W.cross(force_N)};
}

void Scene::read_contacts(std::vector<Contact>& contacts) const {
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    if (contact.efc_address < 0) continue;
    std::array<mjtNum, 6> wrench{};
    mj_contactForce(model_.get(), data_.get(), i, wrench.data());
    const Eigen::Matrix3d axes_W = axes_of(contact);
    if (contact.dist > 0.0 && wrench[0] <= 0.0) continue;              // near, but not touching
    const Vector3d f_W = axes_W * Map<const Vector3d>(wrench.data());  // on the second geom
    const int first = links_[index(contact.geom1)];
    const int second = links_[index(contact.geom2)];
    const bool into_second = first < 0 || second < first;
    const double sign = into_second ? 1.0 : -1.0;
    contacts.push_back({into_second ? second : first, into_second ? first : second,
                        Map<const Vector3d>(contact.pos), sign * axes_W.col(0), sign * f_W,
                        std::max(0.0, -contact.dist)});
  }
}

void Scene::move() {
  std::fill_n(data_->xfrc_applied, 6 * model_->nbody, 0.0);
  mj_Euler(model_.get(), data_.get());
  update_poses();
}

void Scene::update_poses() {
  std::copy_n(data_->qpos, model_->nq, integrated_.begin());
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_comVel(model_.get(), data_.get());
}

void Scene::archive(StateArchive& archive) {
  const auto numbers = [](mjtNum* first, int count) {
    return std::as_writable_bytes(std::span(first, index(count)));
  };
  archive(integrated_);
  archive.bytes(numbers(data_->qvel, model_->nv));
  archive.bytes(numbers(data_->qacc_warmstart, model_->nv));
  archive.bytes(numbers(data_->xfrc_applied, 6 * model_->nbody));
  archive.bytes(std::as_writable_bytes(std::span(data_->warning)));
  archive(data_->time, unconverged_, unsettled_);
  if (archive.writes()) return;
  std::ranges::copy(integrated_, data_->qpos);
  update_poses();
}

BodyState Scene::body(int link) const {
  const int body = body_of(link);
  BodyState state;
  state.X_WL.translation() = vector_at(data_->xpos, body);
  state.X_WL.linear() = Map<const RowMajor3d>(data_->xmat + 9 * body);
  // Velocity of the body at the centre of mass of the whole tree, angular velocity first.
  const Vector3d p_WCom_W = vector_at(data_->subtree_com, model_->body_rootid[body]);
  state.w_WL_W = vector_at(data_->cvel, 2 * body);
  state.v_WCom_W =
      vector_at(data_->cvel, 2 * body + 1) + state.w_WL_W.cross(vector_at(data_->xipos, body) - p_WCom_W);
  return state;
}

std::uint64_t Scene::warnings() const {
  std::uint64_t warnings = unconverged_;
  for (const mjWarningStat& warning : data_->warning) warnings += static_cast<std::uint64_t>(warning.number);
  return warnings;
}

}  // namespace koboshi::sim_board
