#include "sim_board/engine/mujoco/model_text.h"

#include <tinyxml2.h>

#include <array>
#include <charconv>
#include <initializer_list>
#include <stdexcept>

#include "mechanics/axes.h"
#include "sim_board/engine/common/model_constants.h"
#include "sim_board/engine/mujoco/constraint_row.h"

namespace koboshi::sim_board {
namespace {

using tinyxml2::XMLPrinter;

// Dry friction: as in ODE, a row that stops the joint, bounded by Kc. A sticking joint creeps by CFM times
// the torque, 3e-9 rad/s for a small servo; smaller values cost solver iterations.
constexpr Softness kStickingJoint{.error_reduction = 0.0, .constraint_force_mixing = 1e-7};

// Ratio of the tangential to the normal stiffness of MuJoCo's contact rows. A foot creeps by CFM / ratio
// times the tangential force.
constexpr double kTangentHardness = 10.0;

// Memory of a step, 0.13 MB instead of MuJoCo's default of 17 MB. A chain of 20 hinges with 100 contacts and
// 320 rows uses 5,906 numbers (mjData::maxuse_stack, 2026-11-26).
constexpr int kStack_numbers = 1 << 14;

// The relative speed up to which surfaces that meet are slowed down before they overlap (Scene::aim_normals).
// Two hands that swing at the servos' no-load speed meet at 2.5 m/s; a body that falls 2 m, at 6.3 m/s.
constexpr double kMaxMeetingSpeed_m_per_s = 5.0;
constexpr double kMaxLandingSpeed_m_per_s = 10.0;

constexpr int kRowsOfContact = 3;
constexpr int kRowsOfJoint = 2;  // friction and stop, or coupling

std::string text_of(std::initializer_list<double> numbers) {
  std::string text;
  for (const double number : numbers) {
    std::array<char, 32> digits{};  // the shortest text that reads back as the same number
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    text.append(text.empty() ? "" : " ").append(digits.data(), end);
  }
  return text;
}

std::string vector_text(const Eigen::Vector3d& v) { return text_of({v.x(), v.y(), v.z()}); }

std::string quaternion_text(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return text_of({q.w(), q.x(), q.y(), q.z()});
}

void push(XMLPrinter& xml, const char* name, const std::string& value) {
  xml.PushAttribute(name, value.c_str());
}

void push_row(XMLPrinter& xml, const std::string& suffix, const ConstraintRow& row) {
  push(xml, ("solref" + suffix).c_str(), text_of({row.solref_stiffness, row.solref_damping}));
  // The impedance does not depend on the depth.
  push(xml, ("solimp" + suffix).c_str(), text_of({row.impedance, row.impedance, 0.001, 0.5, 2.0}));
}

void push_pose(XMLPrinter& xml, const Eigen::Isometry3d& X) {
  push(xml, "pos", vector_text(X.translation()));
  push(xml, "quat", quaternion_text(X.linear()));
}

class Writer {
 public:
  Writer(XMLPrinter& xml, const RobotDescription& robot, const WorldOptions& options)
      : xml_(xml), robot_(robot), options_(options), boxes_(boxes_of(robot)) {}

  void add_options();
  void add_plane();
  void add_ground_box(int number, const GroundBox& box);
  void add_link(int link, const Eigen::Isometry3d& X_PL, const JointDescription* joint, Base base);
  void add_pair(const TouchingPair& pair);
  void add_coupling(std::size_t joint, const FollowerDescription& follower);

 private:
  void add_inertia(const LinkDescription& link);
  void add_joint(const JointDescription& joint, const Eigen::Isometry3d& X_ML);
  void add_boxes(int link);

  XMLPrinter& xml_;
  const RobotDescription& robot_;
  const WorldOptions& options_;
  const std::vector<NumberedBox> boxes_;
};

void Writer::add_options() {
  xml_.OpenElement("compiler");
  push(xml_, "angle", "radian");
  push(xml_, "inertiafromgeom", "false");
  xml_.CloseElement();
  xml_.OpenElement("option");
  push(xml_, "timestep", text_of({options_.step_s}));
  push(xml_, "gravity", vector_text(options_.gravity_W_m_per_s2));
  push(xml_, "collision", "predefined");
  push(xml_, "cone", "elliptic");
  push(xml_, "solver", "Newton");
  push(xml_, "jacobian", "sparse");  // for 26 degrees of freedom a fifth faster than dense
  push(xml_, "impratio", text_of({kTangentHardness}));
  push(xml_, "iterations", "100");
  push(xml_, "tolerance", "1e-10");
  xml_.CloseElement();
  xml_.OpenElement("size");
  xml_.PushAttribute("nconmax", kMaxContacts);
  xml_.PushAttribute("njmax",
                     kRowsOfContact * kMaxContacts + kRowsOfJoint * static_cast<int>(robot_.joints.size()));
  xml_.PushAttribute("nstack", kStack_numbers);
  xml_.CloseElement();
}

void Writer::add_plane() {
  const Eigen::Vector3d normal = options_.ground.normal_W.normalized();
  xml_.OpenElement("geom");
  push(xml_, "name", geom_name(TouchingPair::kPlane));
  push(xml_, "type", "plane");
  push(xml_, "size", "0 0 1");
  push(xml_, "pos", vector_text(options_.ground.offset_m * normal));
  push(xml_, "quat", quaternion_text(mechanics::rotation_to_normal(normal)));
  xml_.CloseElement();
}

void Writer::add_ground_box(int number, const GroundBox& box) {
  xml_.OpenElement("geom");
  push(xml_, "name", geom_name(TouchingPair::ground_box(number)));
  push(xml_, "type", "box");
  push_pose(xml_, box.X_WG);
  push(xml_, "size", vector_text(0.5 * box.size_m));
  xml_.CloseElement();
}

// Adds a body with its child bodies nested in it.
void Writer::add_link(int number, const Eigen::Isometry3d& X_PL, const JointDescription* joint, Base base) {
  const LinkDescription& link = robot_.links[static_cast<std::size_t>(number)];
  xml_.OpenElement("body");
  push(xml_, "name", "link" + std::to_string(number));
  push_pose(xml_, X_PL);
  if (joint != nullptr) {
    add_joint(*joint, link.X_ML);
  } else if (base == Base::kFree) {
    xml_.OpenElement("freejoint");
    xml_.CloseElement();
  }
  add_inertia(link);
  add_boxes(number);
  for (const JointDescription& next : robot_.joints) {
    if (next.parent != number) continue;
    const LinkDescription& child = robot_.links[static_cast<std::size_t>(next.child)];
    add_link(next.child, link.X_ML.inverse() * child.X_ML, &next, base);
  }
  xml_.CloseElement();
}

void Writer::add_inertia(const LinkDescription& link) {
  const Eigen::Matrix3d& I = link.I_LCom_L;
  xml_.OpenElement("inertial");
  push(xml_, "pos", vector_text(link.p_LCom_L));
  push(xml_, "mass", text_of({link.mass_kg}));
  push(xml_, "fullinertia", text_of({I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}));
  xml_.CloseElement();
}

void Writer::add_joint(const JointDescription& joint, const Eigen::Isometry3d& X_ML) {
  const Softness stop = softness(kStopStiffness_Nm_per_rad, kStopDamping_Nm_s_per_rad, options_.step_s);
  xml_.OpenElement("joint");
  push(xml_, "name", "joint" + std::to_string(&joint - robot_.joints.data()));
  push(xml_, "type", "hinge");
  push(xml_, "pos", vector_text(X_ML.inverse() * joint.p_MJ));
  push(xml_, "axis", vector_text(X_ML.linear().transpose() * joint.axis_M));
  push(xml_, "limited", "true");
  push(xml_, "range", text_of({joint.lower_rad, joint.upper_rad}));
  push_row(xml_, "limit", constraint_row(stop, 1, options_.step_s));
  push_row(xml_, "friction", constraint_row(kStickingJoint, 1, options_.step_s));
  xml_.CloseElement();
}

void Writer::add_boxes(int link) {
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    if (boxes_[i].link != link) continue;
    xml_.OpenElement("geom");
    push(xml_, "name", geom_name(static_cast<int>(i)));
    push(xml_, "type", "box");
    push_pose(xml_, boxes_[i].box->X_LG);
    push(xml_, "size", vector_text(0.5 * boxes_[i].box->size_m));
    xml_.CloseElement();
  }
}

void Writer::add_pair(const TouchingPair& pair) {
  const double first = pair.surface.friction;
  const double second = pair.surface.friction_second;
  xml_.OpenElement("pair");
  push(xml_, "geom1", geom_name(pair.box));
  push(xml_, "geom2", geom_name(pair.other_box));
  push(xml_, "condim", "3");
  push(xml_, "friction", text_of({first, second, 0.0, 0.0, 0.0}));
  push_row(xml_, "", constraint_row(pair.surface.softness, pair.with_ground() ? 1 : 2, options_.step_s));
  const double speed_m_per_s = pair.with_ground() ? kMaxLandingSpeed_m_per_s : kMaxMeetingSpeed_m_per_s;
  push(xml_, "margin", text_of({speed_m_per_s * options_.step_s}));
  xml_.CloseElement();
}

// A follower has no friction, so that its row is one of those of its joint.
void Writer::add_coupling(std::size_t joint, const FollowerDescription& follower) {
  constexpr Softness kCoupling{.error_reduction = kCouplingErrorReduction,
                               .constraint_force_mixing = kCouplingForceMixing};
  xml_.OpenElement("joint");
  push(xml_, "joint1", "joint" + std::to_string(joint));
  push(xml_, "joint2", "joint" + std::to_string(follower.leader));
  push(xml_, "polycoef", text_of({follower.offset_rad, follower.multiplier, 0.0, 0.0, 0.0}));
  push_row(xml_, "", constraint_row(kCoupling, 2, options_.step_s));
  xml_.CloseElement();
}

void check(const SurfaceContact& surface) {
  if (surface.has_direction() || surface.slip_m_per_N_s > 0.0)
    throw std::invalid_argument(
        "MuJoCo's surfaces are alike in all directions, and do not slip as they stick");
}

}  // namespace

std::string geom_name(int box) {
  if (box >= 0) return "box" + std::to_string(box);
  return box == TouchingPair::kPlane ? "ground"
                                     : "ground_box" + std::to_string(TouchingPair::kPlane - 1 - box);
}

std::vector<NumberedBox> boxes_of(const RobotDescription& robot) {
  std::vector<NumberedBox> boxes;
  for (std::size_t l = 0; l < robot.links.size(); ++l)
    for (const BoxDescription& box : robot.links[l].collisions) boxes.push_back({static_cast<int>(l), &box});
  return boxes;
}

std::vector<TouchingPair> touching_pairs(const RobotDescription& robot, const mechanics::HingeTree& tree,
                                         const WorldOptions& options) {
  const GroundDescription& ground = options.ground;
  if (!ground.patches.empty() || !ground.height_fields.empty())
    throw std::invalid_argument("MuJoCo's ground has a plane and boxes, no patches and no height fields");
  const std::vector<NumberedBox> boxes = boxes_of(robot);
  const int count = static_cast<int>(boxes.size());
  std::vector<TouchingPair> pairs;
  const auto add = [&](int box, int other_box, const SurfaceDescription& other) {
    const SurfaceDescription& one = boxes[static_cast<std::size_t>(box)].box->surface;
    pairs.push_back({box, other_box, contact_between(one, other, options.step_s, options.material_pairs)});
    check(pairs.back().surface);
  };
  for (int i = 0; i < count; ++i) {
    if (ground.present) add(i, TouchingPair::kPlane, ground.surface);
    for (std::size_t g = 0; g < ground.boxes.size(); ++g)
      add(i, TouchingPair::ground_box(static_cast<int>(g)), ground.boxes[g].surface);
    for (int j = i + 1; j < count; ++j) {
      const auto& [other_link, other] = boxes[static_cast<std::size_t>(j)];
      const int link = boxes[static_cast<std::size_t>(i)].link;
      if (tree.distance(static_cast<std::size_t>(link), static_cast<std::size_t>(other_link)) >=
          kMinJointsBetween)
        add(i, j, other->surface);
    }
  }
  return pairs;
}

std::string model_text(const RobotDescription& robot, std::span<const FollowerDescription> followers,
                       const std::vector<TouchingPair>& pairs, const WorldOptions& options, Base base) {
  XMLPrinter xml(nullptr, true);
  Writer writer(xml, robot, options);
  xml.OpenElement("mujoco");
  writer.add_options();
  xml.OpenElement("worldbody");
  if (options.ground.present) writer.add_plane();
  for (std::size_t i = 0; i < options.ground.boxes.size(); ++i)
    writer.add_ground_box(static_cast<int>(i), options.ground.boxes[i]);
  writer.add_link(0, options.X_WB, nullptr, base);
  xml.CloseElement();
  xml.OpenElement("contact");
  for (const TouchingPair& pair : pairs) writer.add_pair(pair);
  xml.CloseElement();
  if (!followers.empty()) {
    xml.OpenElement("equality");
    const std::size_t first = robot.joints.size() - followers.size();
    for (std::size_t i = 0; i < followers.size(); ++i) writer.add_coupling(first + i, followers[i]);
    xml.CloseElement();
  }
  xml.CloseElement();
  return xml.CStr();
}

}  // namespace koboshi::sim_board
