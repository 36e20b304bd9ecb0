#include "tools/import/decide/roles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

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

// Returns the axis, x, y or z, about which a joint turns most.
char main_axis(const ImportedRobot& robot, const std::vector<Eigen::Isometry3d>& X_RL,
               const Eigen::Matrix3d& R_MR, std::size_t joint) {
  const ImportedJoint& described = robot.joints[joint];
  const Vector3d axis_M = R_MR * X_RL[static_cast<std::size_t>(described.child)].linear() * described.axis_L;
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
    std::size_t next = 0;
    for (std::size_t i = 0; i < limb.joints.size() && next < kCount; ++i) {
      const ImportedJoint& joint = robot_.joints[limb.joints[i]];
      const char axis = main_axis(robot_, X_RL_, R_MR_, limb.joints[i]);
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
