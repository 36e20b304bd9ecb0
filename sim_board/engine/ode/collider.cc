#include "sim_board/engine/ode/collider.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim_board/engine/common/model_constants.h"
#include "sim_board/engine/ode/eigen.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim_board {
namespace {

// A box has eight corners, and the contact area of two boxes face to face has at most eight.
constexpr int kMaxContactsOfPair = 8;

// Contacts for which memory is allocated in advance; no fall of the robot needs more than 60. For more, it is
// enlarged in the step that needs it.
constexpr std::size_t kUsualContacts = 100;

// Contacts of the same links in two steps are the same one if they are nearer than this.
constexpr double kSameContact_m = 0.005;

// Error of friction that is taken for a solution of ODE's, as a share of the largest normal force.
constexpr double kFrictionTolerance = 2e-3;

dSurfaceParameters ode_surface(const SurfaceContact& surface) {
  dSurfaceParameters ode{};
  // MotionN: the normal's target is that of its NormalRow.
  ode.mode = dContactMu2 | dContactSoftCFM | dContactMotionN;
  ode.mu = surface.friction;
  ode.mu2 = surface.friction_second;
  ode.bounce = surface.bounce;
  ode.bounce_vel = surface.bounce_threshold_m_per_s;
  ode.soft_erp = surface.softness.error_reduction;
  ode.soft_cfm = surface.softness.constraint_force_mixing;
  if (surface.slip_m_per_N_s > 0.0) {
    ode.mode |= dContactSlip1 | dContactSlip2;
    ode.slip1 = ode.slip2 = surface.slip_m_per_N_s;
  }
  if (surface.has_direction()) ode.mode |= dContactFDir1;
  return ode;
}

OdeGeom make_plane(const GroundDescription& ground) {
  const Eigen::Vector3d normal = ground.normal_W.normalized();
  return OdeGeom(dCreatePlane(nullptr, normal.x(), normal.y(), normal.z(), ground.offset_m));
}

OdeGeom make_ground_box(const GroundBox& box) {
  OdeGeom geom(dCreateBox(nullptr, box.size_m.x(), box.size_m.y(), box.size_m.z()));
  const Eigen::Vector3d& p_W = box.X_WG.translation();
  dGeomSetPosition(geom.get(), p_W.x(), p_W.y(), p_W.z());
  dMatrix3 R;
  copy_rotation(box.X_WG.linear(), R);
  dGeomSetRotation(geom.get(), R);
  return geom;
}

// Projects the first friction direction onto the contact plane. Returns false if it is perpendicular to the
// plane; ODE then chooses one.
bool set_direction(const Eigen::Vector3d& direction, dGeomID frame, dContact& contact) {
  const Eigen::Vector3d direction_W =
      frame != nullptr ? Eigen::Vector3d(rotation_of(dGeomGetRotation(frame)) * direction) : direction;
  const Eigen::Vector3d normal_W = vector_of(contact.geom.normal);
  const Eigen::Vector3d in_plane_W = direction_W - normal_W.dot(direction_W) * normal_W;
  if (in_plane_W.norm() < 1e-6 * direction_W.norm()) return false;
  copy_vector(in_plane_W.normalized(), contact.fdir1);
  return true;
}

// Identifies a contact's first row across steps, apart from the rows of the joints.
std::uint64_t row_id(const Contact& contact, int ordinal) {
  const auto bits = [](int number, int shift) { return static_cast<std::uint64_t>(number) << shift; };
  return bits(1, 60) | bits(contact.link, 40) | bits(contact.other_link + 1, 20) | bits(ordinal, 2);
}

// Corners this much above the ground are too far from it whatever the rounding.
constexpr double kClear_m = 1e-6;

// Speed of a body's point, of the ground if the body is null.
Eigen::Vector3d speed_at(dBodyID body, const dVector3 p_W) {
  dVector3 v_W{};
  if (body != nullptr) dBodyGetPointVel(body, p_W[0], p_W[1], p_W[2], v_W);
  return vector_of(v_W);
}

}  // namespace

Collider::Collider(dWorldID world, const RobotDescription& robot, const mechanics::HingeTree& tree,
                   const Bodies& bodies, const WorldOptions& options)
    : world_(world), options_(options), joints_(dJointGroupCreate(0)), boxes_(make_boxes(robot, bodies)) {
  make_ground();
  make_pairs(tree);
  make_fields();
  contacts_.reserve(kUsualContacts);
  last_contacts_.reserve(kUsualContacts);
  touches_.reserve(kUsualContacts);
  feedbacks_.resize(kUsualContacts);
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
      boxes.push_back({std::move(geom),
                       static_cast<int>(l),
                       0.5 * box.size_m,
                       box.surface,
                       p_ComG.norm() + 0.5 * box.size_m.norm(),
                       0.0,
                       {}});
    }
  }
  return boxes;
}

void Collider::make_ground() {
  if (options_.ground.present) plane_ = make_plane(options_.ground);
  plane_normal_W_ = options_.ground.normal_W.normalized();
  for (const GroundBox& box : options_.ground.boxes) ground_boxes_.push_back(make_ground_box(box));
}

void Collider::make_pairs(const mechanics::HingeTree& tree) {
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const Box& box = boxes_[b];
    make_ground_pairs(b);
    for (std::size_t o = b + 1; o < boxes_.size(); ++o) {
      const Box& other = boxes_[o];
      if (tree.distance(static_cast<std::size_t>(box.link), static_cast<std::size_t>(other.link)) >=
          kMinJointsBetween)
        pairs_.push_back({box.geom.get(), other.geom.get(), b, o, {}, meet_box(box, other), false});
    }
  }
}

void Collider::make_ground_pairs(std::size_t number) {
  const Box& box = boxes_[number];
  const GroundDescription& ground = options_.ground;
  if (plane_) {
    const std::size_t meeting = collide_with_ground(box, ground.surface, Eigen::Matrix3d::Identity());
    for (const FrictionPatch& patch : ground.patches)
      collide_with_ground(box, patch.surface, patch.X_WP.linear());
    pairs_.push_back({box.geom.get(), plane_.get(), number, kGround, {}, meeting, true});
  }
  for (std::size_t i = 0; i < ground_boxes_.size(); ++i) {
    const std::size_t meeting =
        collide_with_ground(box, ground.boxes[i].surface, ground.boxes[i].X_WG.linear());
    pairs_.push_back({box.geom.get(), ground_boxes_[i].get(), number, kGround,
                      bounds_of(ground_boxes_[i].get()), meeting, false});
  }
}

void Collider::make_fields() {
  Eigen::Vector3d largest_half_m = Eigen::Vector3d::Zero();
  for (const Box& box : boxes_) largest_half_m = largest_half_m.cwiseMax(box.half_m);
  for (const HeightField& field : options_.ground.height_fields) {
    fields_.push_back({HeightFieldContact(field, largest_half_m), meetings_.size()});
    for (const Box& box : boxes_) collide_with_ground(box, field.surface, field.X_WF.linear());
  }
}

std::size_t Collider::collide_with_ground(const Box& box, const SurfaceDescription& ground,
                                          const Eigen::Matrix3d& R_W) {
  Meeting meeting;
  meeting.contact = contact_between(box.surface, ground, options_.step_s, options_.material_pairs);
  meeting.surface = ode_surface(meeting.contact);
  const bool is_of_box = box.surface.friction_direction.has_value();
  meeting.direction = is_of_box ? *box.surface.friction_direction
                                : R_W * ground.friction_direction.value_or(Eigen::Vector3d::UnitX());
  meeting.direction_frame = is_of_box ? box.geom.get() : nullptr;
  meetings_.push_back(meeting);
  return meetings_.size() - 1;
}

std::size_t Collider::meet_box(const Box& box, const Box& other) {
  const Box& directed = box.surface.friction_direction ? box : other;
  const SurfaceContact contact =
      contact_between(box.surface, other.surface, options_.step_s, options_.material_pairs);
  meetings_.push_back({ode_surface(contact), contact,
                       directed.surface.friction_direction.value_or(Eigen::Vector3d::UnitX()),
                       directed.geom.get()});
  return meetings_.size() - 1;
}

void Collider::find_contacts() {
  last_contacts_.swap(contacts_);
  contacts_.clear();
  touches_.clear();
  impact_share_ = 1.0;
  find_bounds();
  for (const Pair& pair : pairs_)
    if (may_meet(pair)) find_contacts_of(pair);
  find_contacts_with_fields();
}

void Collider::find_bounds() {
  for (Box& box : boxes_) {
    const dBodyID body = dGeomGetBody(box.geom.get());
    const double speed_m_per_s =
        vector_of(dBodyGetLinearVel(body)).norm() + box.radius_m * vector_of(dBodyGetAngularVel(body)).norm();
    box.reach_m = kReach_steps * options_.step_s * speed_m_per_s;
    box.bounds = bounds_of(box.geom.get());
  }
}

// Returns false if the bounds exclude a contact in this step.
bool Collider::may_meet(const Pair& pair) const {
  const Box& box = boxes_[pair.box];
  if (pair.is_plane) return !is_above_plane(box);
  if (pair.other_box == kGround) return !apart_by(box.bounds, pair.ground_bounds, box.reach_m);
  const Box& other = boxes_[pair.other_box];
  return !apart_by(box.bounds, other.bounds, box.reach_m + other.reach_m);
}

void Collider::find_contacts_of(const Pair& pair) {
  const Box& box = boxes_[pair.box];
  const Box* const other = pair.other_box == kGround ? nullptr : &boxes_[pair.other_box];
  const double reach_m = box.reach_m + (other != nullptr ? other->reach_m : 0.0);
  const Bounds& other_bounds = other != nullptr ? other->bounds : pair.ground_bounds;
  std::array<dContactGeom, kMaxContactsOfPair> points;
  const std::size_t count =
      pair.is_plane
          ? touch_plane(box, points)
          : near_.find(pair.geom, pair.other_geom, !apart_by(box.bounds, other_bounds, 0.0), reach_m, points);
  for (const dContactGeom& point : std::span(points).first(count))
    add_contact(point, box.link, other != nullptr ? other->link : -1, dGeomGetBody(pair.geom),
                dGeomGetBody(pair.other_geom), meeting_at(pair, point));
}

// Whether the lowest corner is above the reach.
bool Collider::is_above_plane(const Box& box) const {
  const Eigen::Vector3d p_W = vector_of(dGeomGetPosition(box.geom.get()));
  const Eigen::Matrix3d R = rotation_of(dGeomGetRotation(box.geom.get()));
  const double down_m = (R.transpose() * plane_normal_W_).cwiseAbs().dot(box.half_m);
  return plane_normal_W_.dot(p_W) - down_m > options_.ground.offset_m + box.reach_m + kClear_m;
}

// The plane is raised by the reach, so that ODE also finds the corners above it.
std::size_t Collider::touch_plane(const Box& box, std::span<dContactGeom> points) {
  const Eigen::Vector3d& n_W = plane_normal_W_;
  dGeomPlaneSetParams(plane_.get(), n_W.x(), n_W.y(), n_W.z(), options_.ground.offset_m + box.reach_m);
  const int count =
      dCollide(box.geom.get(), plane_.get(), kMaxContactsOfPair, points.data(), sizeof(dContactGeom));
  for (dContactGeom& point : points.first(static_cast<std::size_t>(count))) point.depth -= box.reach_m;
  return static_cast<std::size_t>(count);
}

void Collider::find_contacts_with_fields() {
  for (Field& field : fields_) {
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      const Box& box = boxes_[i];
      for (const HeightFieldContact::Point& point :
           field.contact.touch(pose_of(box.geom.get()), box.half_m, box.reach_m, kMaxContactsOfPair)) {
        dContactGeom geom{};
        copy_vector(point.p_W, geom.pos);
        copy_vector(point.n_W, geom.normal);
        geom.depth = point.depth_m;
        geom.g1 = box.geom.get();
        add_contact(geom, box.link, -1, dGeomGetBody(box.geom.get()), nullptr,
                    meetings_[field.first_meeting + i]);
      }
    }
  }
}

const Collider::Meeting& Collider::meeting_at(const Pair& pair, const dContactGeom& point) const {
  if (pair.is_plane) {
    const std::vector<FrictionPatch>& patches = options_.ground.patches;
    for (std::size_t i = patches.size(); i > 0; --i)
      if (patches[i - 1].holds(vector_of(point.pos))) return meetings_[pair.meeting + i];
  }
  return meetings_[pair.meeting];
}

void Collider::add_contact(const dContactGeom& point, int link, int other_link, dBodyID body,
                           dBodyID other_body, const Meeting& meeting) {
  const Eigen::Vector3d v_W = speed_at(body, point.pos) - speed_at(other_body, point.pos);
  const double approach_m_per_s = -vector_of(point.normal).dot(v_W);
  const std::optional<NormalRow> normal =
      normal_row(meeting.contact, point.depth, approach_m_per_s, options_.step_s);
  if (!normal) return;
  dContact contact{};
  contact.surface = meeting.surface;
  contact.geom = point;
  if ((meeting.surface.mode & dContactFDir1) != 0 &&
      !set_direction(meeting.direction, meeting.direction_frame, contact))
    contact.surface.mode &= ~dContactFDir1;
  const bool same_pair =
      !contacts_.empty() && contacts_.back().link == link && contacts_.back().other_link == other_link;
  touches_.push_back({contact, body, other_body, same_pair ? touches_.back().ordinal + 1 : 0, v_W, *normal,
                      friction_law(contact.surface), friction_axes(contact)});
  contacts_.push_back({link, other_link, vector_of(contact.geom.pos), vector_of(contact.geom.normal),
                       Eigen::Vector3d::Zero(), contact.geom.depth});
  touches_.back().guess = guess_friction(touches_.back(), contacts_.back());
}

// Starts from the force that the contact had in the last step. The normal force of a new one is unknown.
FrictionGuess Collider::guess_friction(const Touch& touch, const Contact& contact) const {
  if (!touch.has_friction()) return {};
  Eigen::Vector3d last_f_W = Eigen::Vector3d::Zero();
  double nearest_m = kSameContact_m;
  for (const Contact& last : last_contacts_) {
    if (last.link != contact.link || last.other_link != contact.other_link) continue;
    const double distance_m = (last.p_W - contact.p_W).norm();
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    last_f_W = last.f_W;
  }
  return better_guess(touch.friction, touch.solution(last_f_W, touch.v_W), touch.mass_kg() / options_.step_s);
}

void Collider::make_joints() {
  dJointGroupEmpty(joints_.get());
  if (feedbacks_.size() < touches_.size()) feedbacks_.resize(touches_.size());
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    const dContact contact = ode_contact(touches_[i], target_m_per_s(touches_[i].normal));
    const dJointID joint = dJointCreateContact(world_, joints_.get(), &contact);
    dJointAttach(joint, touches_[i].body, touches_[i].other_body);
    dJointSetFeedback(joint, &feedbacks_[i]);
  }
}

bool Collider::improve_friction() {
  FrictionSearch search;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    Touch& touch = touches_[i];
    if (!touch.has_friction()) continue;
    search.improve(touch.friction, touch.solution(contacts_[i].f_W, touch.velocity_after(options_.step_s)),
                   touch.mass_kg() / options_.step_s, touch.guess);
  }
  return search.error() <= kFrictionTolerance;
}

void Collider::read_joint_forces() {
  for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_[i].f_W = vector_of(feedbacks_[i].f1);
}

// Equations are those of ODE's contact joint.
void Collider::add_rows(std::size_t contact, TreeSolver& solver, const Bodies& bodies,
                        const Eigen::Vector3d& p_WO_W) {
  std::vector<TreeRow>& rows = solver.rows();
  Touch& touch = touches_[contact];
  const Contact& point = contacts_[contact];
  const Eigen::Vector3d p_O = point.p_W - p_WO_W;
  TreeRow row{.body = static_cast<int>(bodies.index_of(point.link))};
  if (point.other_link >= 0) row.other_body = static_cast<int>(bodies.index_of(point.other_link));
  const auto lay_along = [&](const Eigen::Vector3d& direction_W) {
    row.jacobian = mechanics::spatial_force(p_O, direction_W);
    if (row.other_body >= 0) row.other_jacobian = -row.jacobian;
  };
  touch.first_row = rows.size();
  row.id = row_id(point, touch.ordinal);

  lay_along(point.n_W);
  const double step_s = options_.step_s;
  row.target = target_m_per_s(touch.normal);
  row.softness = touch.normal.force_mixing / step_s;
  row.lower = 0.0;
  rows.push_back(row);

  if (touch.has_friction()) {
    row.target = 0.0;
    row.softness = (touch.slips() ? touch.contact.surface.slip1 : kStickingForceMixing) / step_s;
    solver.frictions().push_back({touch.first_row, touch.friction, touch.guess});
    TreeFriction& friction = solver.frictions().back();
    friction.guess.normal *= step_s;
    for (std::size_t i = 0; i < friction.rows(); ++i) {
      lay_along(touch.axes_W[i]);
      ++row.id;
      rows.push_back(row);
    }
  }
  touch.rows = rows.size() - touch.first_row;
}

void Collider::read_guesses(const TreeSolver& solver) {
  auto next = solver.frictions().begin();
  for (Touch& touch : touches_) {
    if (!touch.has_friction()) continue;
    touch.guess = (next++)->guess;
    touch.guess.normal /= options_.step_s;
  }
}

void Collider::read_row_forces(const TreeSolver& solver) {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    contacts_[i].f_W.setZero();
    const std::size_t first = touches_[i].first_row;
    for (std::size_t row = first; row < first + touches_[i].rows; ++row)
      contacts_[i].f_W += solver.impulse(row) / options_.step_s * solver.row(row).jacobian.tail<3>();
  }
}

void Collider::set_forces(std::size_t first, std::span<const Eigen::Vector3d> forces_W) {
  for (std::size_t i = 0; i < forces_W.size(); ++i) contacts_[first + i].f_W = forces_W[i];
}

bool Collider::has_impacts() const {
  return std::ranges::any_of(touches_, [](const Touch& touch) { return touch.normal.is_impact; });
}

double Collider::impact_work_J() const {
  double work_J = 0.0;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    const Touch& touch = touches_[i];
    if (!touch.normal.is_impact) continue;
    const Eigen::Vector3d after_W =
        speed_at(touch.body, touch.contact.geom.pos) - speed_at(touch.other_body, touch.contact.geom.pos);
    work_J += 0.5 * options_.step_s * contacts_[i].f_W.dot(touch.v_W + after_W);
  }
  return work_J;
}

void Collider::drop_gaps() {
  std::erase_if(contacts_, [](const Contact& contact) {
    return contact.depth_m < 0.0 && contact.f_W.dot(contact.n_W) <= 0.0;
  });
  for (Contact& contact : contacts_) contact.depth_m = std::max(contact.depth_m, 0.0);
}

void Collider::archive(StateArchive& archive) { archive(contacts_); }

}  // namespace koboshi::sim_board
