#include "tools/import/decide/roles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/import/decide/limbs.h"
#include "tools/import/decide/role_joints.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

const std::vector<std::string> kAxisNames{"x", "-x", "y", "-y", "z", "-z"};

Vector3d axis_of(const std::string& name) {
  const double sign = name.starts_with('-') ? -1.0 : 1.0;
  return sign * Vector3d::Unit(name.back() - 'x');
}

std::string name_of_axis(const Vector3d& axis) {
  int index = 0;
  axis.cwiseAbs().maxCoeff(&index);
  return std::string(axis[index] < 0.0 ? "-" : "") + static_cast<char>('x' + index);
}

// Returns the axis of a joint in M.
Vector3d axis_in_model(const ImportedRobot& robot, const std::vector<Eigen::Isometry3d>& X_RL,
                       const Eigen::Matrix3d& R_MR, std::size_t joint) {
  const ImportedJoint& described = robot.joints[joint];
  return R_MR * X_RL[static_cast<std::size_t>(described.child)].linear() * described.axis_L;
}

// Returns the axis, x, y or z, about which a joint turns most.
char main_axis(const Vector3d& axis_M) {
  int index = 0;
  axis_M.cwiseAbs().maxCoeff(&index);
  return static_cast<char>('x' + index);
}

class RoleFinder {
 public:
  RoleFinder(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR, ImportReport& report)
      : robot_(robot), R_MR_(R_MR), X_RL_(link_poses(robot)), report_(report) {}

  std::map<std::string, std::string> find() {
    std::vector<Limb> limbs = limbs_of(robot_, R_MR_);
    if (limbs.size() < 2) return {};
    const double middle_y = middle_of(limbs);
    name_pair(limbs, middle_y, kLegRoles, &Limb::last_m);
    name_pair(limbs, middle_y, kArmRoles, nullptr);
    name_head(limbs, middle_y);
    return std::move(roles_);
  }

 private:
  static double middle_of(const std::vector<Limb>& limbs) {
    double lowest = 0.0;
    double highest = 0.0;
    for (const Limb& limb : limbs) {
      lowest = std::min(lowest, limb.first_m.y());
      highest = std::max(highest, limb.first_m.y());
    }
    return 0.5 * (lowest + highest);
  }

  // The two limbs on either side that end lowest (legs), or those that are left (arms).
  template <std::size_t kCount>
  void name_pair(std::vector<Limb>& limbs, double middle_y, const std::array<RoleJoint, kCount>& roles,
                 Vector3d Limb::*lowest) {
    constexpr double kBeside_m = 0.005;
    std::array<std::optional<std::size_t>, 2> found;
    for (std::size_t i = 0; i < limbs.size(); ++i) {
      const double beside = limbs[i].first_m.y() - middle_y;
      if (std::abs(beside) < kBeside_m) continue;
      auto& best = found[beside > 0.0 ? 0 : 1];
      const bool is_better =
          !best || (lowest != nullptr ? (limbs[i].*lowest).z() < (limbs[*best].*lowest).z()
                                      : limbs[i].joints.size() > limbs[*best].joints.size());
      if (is_better) best = i;
    }
    if (!found[0] || !found[1]) return;
    name_limb(limbs[*found[0]], "left_", roles);
    name_limb(limbs[*found[1]], "right_", roles);
    for (const std::size_t i : {std::max(*found[0], *found[1]), std::min(*found[0], *found[1])})
      limbs.erase(limbs.begin() + static_cast<std::ptrdiff_t>(i));
  }

  void name_head(const std::vector<Limb>& limbs, double middle_y) {
    constexpr double kMiddle_m = 0.02;
    for (const Limb& limb : limbs) {
      if (std::abs(limb.first_m.y() - middle_y) > kMiddle_m) continue;
      name_limb(limb, "", kHeadRoles);
      return;
    }
  }

  // By place where a limb has as many joints as roles: an axis may stand at 45 degrees. Else by axis, in
  // order.
  template <std::size_t kCount>
  void name_limb(const Limb& limb, const std::string& side, const std::array<RoleJoint, kCount>& roles) {
    std::vector<std::size_t> joints = limb.joints;
    // Of legs with five joints, some have no ankle roll, and others no hip yaw.
    const bool lacks_last = kCount == kLegRoles.size() && joints.size() == kCount - 1 &&
                            main_axis(axis_of_joint(joints.back())) == roles[kCount - 2].axis;
    const bool is_by_place = joints.size() >= kCount || lacks_last;
    if (is_by_place) order_by_role(joints, roles);
    std::size_t next = 0;
    for (std::size_t i = 0; i < joints.size() && next < kCount; ++i) {
      const ImportedJoint& joint = robot_.joints[joints[i]];
      const char axis = main_axis(axis_of_joint(joints[i]));
      std::size_t role = next;
      if (!is_by_place)
        while (role < kCount && roles[role].axis != axis) ++role;
      if (role == kCount) continue;
      roles_[side + std::string(roles[role].name)] = joint.name;
      if (axis != roles[role].axis && kCount == kLegRoles.size())
        report_.warnings.push_back(
            fmt::format("line {}: {} as {}{} turns about {} in the source's zero pose, not {}", joint.line,
                        one_line(joint.name), side, roles[role].name, axis, roles[role].axis));
      next = role + 1;
    }
  }

  // Legs have their three hip joints first, in any order, then the knee, then the two of the ankle in any
  // order. An arm that is longer than its roles has joints that twist it, which are no elbows.
  template <std::size_t kCount>
  void order_by_role(std::vector<std::size_t>& joints, const std::array<RoleJoint, kCount>& roles) const {
    if constexpr (kCount == kLegRoles.size()) {
      order_by_axis(std::span(joints).first(3), std::span(roles).first(3));
      if (joints.size() >= kCount)
        order_by_axis(std::span(joints).subspan(4, 2), std::span(roles).subspan(4, 2));
    } else if constexpr (kCount == kArmRoles.size()) {
      const auto elbow = std::find_if_not(joints.begin() + 2, joints.end(),
                                          [this](std::size_t joint) { return twists(joint); });
      if (elbow != joints.end()) std::iter_swap(joints.begin() + 2, elbow);
    }
  }

  // Puts joints into the order of the roles whose axes they turn about most. The order from the trunk
  // outwards stays where another one is hardly better: an axis may stand between two of the base.
  void order_by_axis(std::span<std::size_t> joints, std::span<const RoleJoint> roles) const {
    constexpr double kBetter = 0.1;
    std::vector<std::size_t> places(joints.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    const auto agreement = [&] {
      double sum = 0.0;
      for (std::size_t i = 0; i < places.size(); ++i)
        sum += std::abs(axis_of_joint(joints[places[i]])[roles[i].axis - 'x']);
      return sum;
    };
    std::vector<std::size_t> best = places;
    double highest = agreement();
    while (std::ranges::next_permutation(places).found) {
      if (agreement() < highest + kBetter) continue;
      highest = agreement();
      best = places;
    }
    std::vector<std::size_t> ordered;
    for (const std::size_t place : best) ordered.push_back(joints[place]);
    std::ranges::copy(ordered, joints.begin());
  }

  // Whether a joint turns about the line to the centre of what it carries.
  bool twists(std::size_t joint) const {
    constexpr double kAlong = 0.8;
    double mass_kg = 0.0;
    Vector3d moment = Vector3d::Zero();
    for (std::size_t link = 0; link < robot_.links.size(); ++link) {
      if (!carries(joint, static_cast<int>(link))) continue;
      const double share_kg = std::max(robot_.links[link].mass_kg, 1e-9);
      mass_kg += share_kg;
      moment += share_kg * (R_MR_ * (X_RL_[link] * robot_.links[link].p_LCom_L));
    }
    const Vector3d along = moment / mass_kg - anchor(joint);
    return std::abs(axis_of_joint(joint).dot(along)) > kAlong * along.norm();
  }
  bool carries(std::size_t joint, int link) const {
    for (int at = joint_of(robot_, link); at >= 0;
         at = joint_of(robot_, robot_.joints[static_cast<std::size_t>(at)].parent))
      if (static_cast<std::size_t>(at) == joint) return true;
    return false;
  }

  Vector3d anchor(std::size_t joint) const {
    return R_MR_ * X_RL_[static_cast<std::size_t>(robot_.joints[joint].child)].translation();
  }
  Vector3d axis_of_joint(std::size_t joint) const { return axis_in_model(robot_, X_RL_, R_MR_, joint); }

  const ImportedRobot& robot_;
  const Eigen::Matrix3d& R_MR_;
  std::vector<Eigen::Isometry3d> X_RL_;
  ImportReport& report_;
  std::map<std::string, std::string> roles_;
};

// The firmware walks legs with all roles but hip yaw; both sides have the same ones.
void warn_of_missing_roles(const std::map<std::string, std::string>& roles, ImportReport& report) {
  std::string missing;
  std::size_t found = 0;
  for (const RoleJoint& role : kLegRoles) {
    if (role.name == "hip_yaw") continue;
    if (roles.contains("left_" + std::string(role.name))) {
      ++found;
    } else {
      missing += (missing.empty() ? "" : ", ") + std::string(role.name);
    }
  }
  if (found == 0 || missing.empty()) return;
  report.warnings.push_back("legs without " + missing +
                            ": the firmware plays motions on such a robot, but cannot walk it");
}

}  // namespace

Eigen::Matrix3d decide_axes(const ImportedRobot& robot, Interview& interview) {
  const std::vector<Limb> limbs = limbs_of(robot, Eigen::Matrix3d::Identity());
  const std::string up = interview.answer(
      {"up", "Which axis of the source points up?", name_of_axis(find_up(limbs)), kAxisNames});
  const std::string forward =
      interview.answer({"forward", "Which axis of the source points forward?",
                        name_of_axis(find_forward(robot, limbs, axis_of(up))), kAxisNames});
  const Vector3d z = axis_of(up);
  const Vector3d x = axis_of(forward);
  if (std::abs(x.dot(z)) > 0.5)
    throw InputError(robot.file, 0, "the answers up: " + up + " and forward: " + forward,
                     "two different axes");
  Eigen::Matrix3d R_MR;
  R_MR << x.transpose(), z.cross(x).transpose(), z.transpose();
  return R_MR;
}

void decide_roles(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR, Interview& interview,
                  ImportReport& report) {
  std::map<std::string, std::string> roles = RoleFinder(robot, R_MR, report).find();
  for (const auto& [name, source] : interview.given().joints) {
    if (!robot.find_joint(source) && !interview.given().locked_deg.contains(source))
      throw interview.error("joints", name, "no joint " + one_line(source) + " for " + name,
                            "a joint of the source, or no such entry in joints");
    std::erase_if(roles, [&](const auto& entry) { return entry.second == source; });
    roles[name] = source;
  }
  if (!roles.contains("left_knee") || !roles.contains("right_knee"))
    report.warnings.push_back(
        "no two legs found: import.md shows which axes were taken for up and forward, and joints in "
        "import.yaml names the firmware's joints");
  // Joints of one side only have no role: the firmware needs both.
  for (auto entry = roles.begin(); entry != roles.end();)
    entry = roles.contains(mirrored_name(entry->first)) ? std::next(entry) : roles.erase(entry);
  warn_of_missing_roles(roles, report);
  interview.taken.joints = std::move(roles);
}

}  // namespace koboshi::tools
