#include "tools/import/decide/roles.h"

#include <algorithm>
#include <cmath>
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

// Returns the axis, x, y or z, that is nearest to a direction.
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

  Vector3d axis_M(std::size_t joint) const {
    const ImportedJoint& described = robot_.joints[joint];
    return R_MR_ * X_RL_[static_cast<std::size_t>(described.child)].linear() * described.axis_L;
  }
  Vector3d anchor_M(std::size_t joint) const {
    return R_MR_ * X_RL_[static_cast<std::size_t>(robot_.joints[joint].child)].translation();
  }

  // Joints of a limb in the order of the roles. Those of a leg with all six are taken by place, hip and ankle
  // each in the order that fits the axes best: yaw, roll and pitch of a hip come in any order, and an axis
  // may stand at 45 degrees. Those of an arm are taken by place, without twists of the upper arm before the
  // elbow.
  template <std::size_t kCount>
  std::vector<std::size_t> in_order(const Limb& limb, const std::array<RoleJoint, kCount>& roles) const {
    std::vector<std::size_t> joints = limb.joints;
    if (joints.size() < kCount) return joints;
    if constexpr (kCount == kLegRoles.size()) {
      sort_by_axes(std::span(joints).subspan(0, 3), std::span(roles).subspan(0, 3));
      sort_by_axes(std::span(joints).subspan(4, 2), std::span(roles).subspan(4, 2));
    } else if constexpr (kCount == kArmRoles.size()) {
      std::size_t elbow = kCount - 1;
      while (elbow < joints.size() && is_twist(joints, elbow)) ++elbow;
      if (elbow < joints.size()) std::swap(joints[kCount - 1], joints[elbow]);
    }
    return joints;
  }

  // Keeps the order unless another one fits clearly better.
  void sort_by_axes(std::span<std::size_t> joints, std::span<const RoleJoint> roles) const {
    constexpr double kClear = 0.3;
    const auto fit = [&](const std::vector<std::size_t>& order) {
      double sum = 0.0;
      for (std::size_t i = 0; i < order.size(); ++i) sum += std::abs(axis_M(order[i])[roles[i].axis - 'x']);
      return sum;
    };
    const std::vector<std::size_t> given(joints.begin(), joints.end());
    std::vector<std::size_t> order = given;
    std::ranges::sort(order);
    double best = fit(given) + kClear;
    do {
      if (fit(order) <= best) continue;
      best = fit(order);
      std::ranges::copy(order, joints.begin());
    } while (std::ranges::next_permutation(order).found);
  }

  // A joint that turns the limb about its own direction: the way to the next anchor.
  bool is_twist(const std::vector<std::size_t>& joints, std::size_t at) const {
    constexpr double kAlong = 0.85;
    constexpr double kApart_m = 1e-3;
    for (std::size_t next = at + 1; next < joints.size(); ++next) {
      const Vector3d way = anchor_M(joints[next]) - anchor_M(joints[at]);
      if (way.norm() > kApart_m) return std::abs(way.normalized().dot(axis_M(joints[at]))) > kAlong;
    }
    return false;
  }

  // By axis where a limb has fewer joints than roles.
  template <std::size_t kCount>
  void name_limb(const Limb& limb, const std::string& side, const std::array<RoleJoint, kCount>& roles) {
    std::size_t next = 0;
    for (const std::size_t index : in_order(limb, roles)) {
      if (next == kCount) break;
      const ImportedJoint& joint = robot_.joints[index];
      const char axis = main_axis(axis_M(index));
      std::size_t role = next;
      if (limb.joints.size() < kCount)
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

  const ImportedRobot& robot_;
  const Eigen::Matrix3d& R_MR_;
  std::vector<Eigen::Isometry3d> X_RL_;
  ImportReport& report_;
  std::map<std::string, std::string> roles_;
};

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
      throw InputError(robot.file, 0, "no joint " + one_line(source) + " for " + name,
                       "a joint of the source, or no such entry in joints");
    std::erase_if(roles, [&](const auto& entry) { return entry.second == source; });
    roles[name] = source;
  }
  // Joints of one side only have no role: the firmware needs both.
  for (auto entry = roles.begin(); entry != roles.end();)
    entry = roles.contains(mirrored_name(entry->first)) ? std::next(entry) : roles.erase(entry);
  interview.taken.joints = std::move(roles);
}

}  // namespace koboshi::tools
