#include "tools/import/decide/roles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/import/decide/role_joints.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

const std::vector<std::string> kAxisNames{"x", "-x", "y", "-y", "z", "-z"};

Vector3d axis_of(const std::string& name) {
  const double sign = name.starts_with('-') ? -1.0 : 1.0;
  return sign * Vector3d::Unit(name.back() - 'x');
}

// Joints from the root to the end of a limb.
struct Chain {
  std::vector<std::size_t> joints{};
  Vector3d first = Vector3d::Zero();  // anchor of its first joint, in M
  Vector3d last = Vector3d::Zero();

  Vector3d length() const { return last - first; }
};

std::vector<Chain> chains_of(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR) {
  const std::vector<Eigen::Isometry3d> X_RL = link_poses(robot);
  std::vector<bool> is_parent(robot.links.size(), false);
  for (const ImportedJoint& joint : robot.joints) is_parent[static_cast<std::size_t>(joint.parent)] = true;
  std::vector<Chain> chains;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    if (is_parent[static_cast<std::size_t>(robot.joints[i].child)]) continue;
    Chain chain;
    for (int at = static_cast<int>(i); at >= 0;
         at = joint_of(robot, robot.joints[static_cast<std::size_t>(at)].parent))
      chain.joints.insert(chain.joints.begin(), static_cast<std::size_t>(at));
    const auto anchor = [&](std::size_t joint) -> Vector3d {
      return R_MR * X_RL[static_cast<std::size_t>(robot.joints[joint].child)].translation();
    };
    chain.first = anchor(chain.joints.front());
    chain.last = anchor(chain.joints.back());
    chains.push_back(std::move(chain));
  }
  return chains;
}

// The joints of a chain that no other chain has: a limb above a waist joint begins below it.
void remove_shared(std::vector<Chain>& chains, const ImportedRobot& robot, const Eigen::Matrix3d& R_MR) {
  std::map<std::size_t, int> users;
  for (const Chain& chain : chains)
    for (const std::size_t joint : chain.joints) ++users[joint];
  const std::vector<Eigen::Isometry3d> X_RL = link_poses(robot);
  for (Chain& chain : chains) {
    std::erase_if(chain.joints, [&](std::size_t joint) { return users[joint] > 1; });
    if (!chain.joints.empty())
      chain.first =
          R_MR * X_RL[static_cast<std::size_t>(robot.joints[chain.joints.front()].child)].translation();
  }
  std::erase_if(chains, [](const Chain& chain) { return chain.joints.empty(); });
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
    std::vector<Chain> chains = chains_of(robot_, R_MR_);
    // A gripper's fingers share a wrist: the longest chain below a joint is the limb.
    keep_one_chain_per_limb(chains);
    remove_shared(chains, robot_, R_MR_);
    if (chains.size() < 2) return {};
    const double middle_y = middle_of(chains);
    name_pair(chains, middle_y, kLegRoles, &Chain::last);
    name_pair(chains, middle_y, kArmRoles, nullptr);
    name_head(chains, middle_y);
    return std::move(roles_);
  }

 private:
  void keep_one_chain_per_limb(std::vector<Chain>& chains) const {
    std::ranges::stable_sort(
        chains, [](const Chain& a, const Chain& b) { return a.joints.size() > b.joints.size(); });
    std::vector<Chain> kept;
    for (const Chain& chain : chains) {
      // Chains that part after two or more joints are one limb, unless the first joints are a waist, whose
      // limbs part to the sides.
      const bool is_branch = std::ranges::any_of(kept, [&chain](const Chain& other) {
        std::size_t shared = 0;
        while (shared < std::min(chain.joints.size(), other.joints.size()) &&
               chain.joints[shared] == other.joints[shared])
          ++shared;
        return shared >= 3;
      });
      if (!is_branch) kept.push_back(chain);
    }
    chains = std::move(kept);
  }

  static double middle_of(const std::vector<Chain>& chains) {
    double lowest = 0.0;
    double highest = 0.0;
    for (const Chain& chain : chains) {
      lowest = std::min(lowest, chain.first.y());
      highest = std::max(highest, chain.first.y());
    }
    return 0.5 * (lowest + highest);
  }

  // The two chains on either side that end lowest (legs), or those that are left (arms).
  template <std::size_t kCount>
  void name_pair(std::vector<Chain>& chains, double middle_y, const std::array<RoleJoint, kCount>& roles,
                 Vector3d Chain::*lowest) {
    constexpr double kBeside_m = 0.005;
    std::array<std::optional<std::size_t>, 2> found;
    for (std::size_t i = 0; i < chains.size(); ++i) {
      const double beside = chains[i].first.y() - middle_y;
      if (std::abs(beside) < kBeside_m) continue;
      auto& best = found[beside > 0.0 ? 0 : 1];
      const bool is_better =
          !best || (lowest != nullptr ? (chains[i].*lowest).z() < (chains[*best].*lowest).z()
                                      : chains[i].joints.size() > chains[*best].joints.size());
      if (is_better) best = i;
    }
    if (!found[0] || !found[1]) return;
    name_limb(chains[*found[0]], "left_", roles);
    name_limb(chains[*found[1]], "right_", roles);
    for (const std::size_t i : {std::max(*found[0], *found[1]), std::min(*found[0], *found[1])})
      chains.erase(chains.begin() + static_cast<std::ptrdiff_t>(i));
  }

  void name_head(const std::vector<Chain>& chains, double middle_y) {
    constexpr double kMiddle_m = 0.02;
    for (const Chain& chain : chains) {
      if (std::abs(chain.first.y() - middle_y) > kMiddle_m) continue;
      name_limb(chain, "", kHeadRoles);
      return;
    }
  }

  // By place where a limb has as many joints as roles: an axis may stand at 45 degrees. Else by axis, in
  // order.
  template <std::size_t kCount>
  void name_limb(const Chain& chain, const std::string& side, const std::array<RoleJoint, kCount>& roles) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < chain.joints.size() && next < kCount; ++i) {
      const ImportedJoint& joint = robot_.joints[chain.joints[i]];
      const char axis = main_axis(robot_, X_RL_, R_MR_, chain.joints[i]);
      std::size_t role = next;
      if (chain.joints.size() < kCount)
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
  // The two chains with the most joints are the legs of most robots, and hang down from their first joint:
  // the root may be a place on the ground.
  std::vector<Chain> chains = chains_of(robot, Eigen::Matrix3d::Identity());
  std::ranges::stable_sort(chains, [](const Chain& a, const Chain& b) {
    return std::pair(a.joints.size(), a.length().norm()) > std::pair(b.joints.size(), b.length().norm());
  });
  Vector3d down = Vector3d::Zero();
  for (std::size_t i = 0; i < std::min<std::size_t>(2, chains.size()); ++i) down += chains[i].length();
  int index = 2;
  std::string up = "z";
  if (down.norm() > 0.0 && down.cwiseAbs().maxCoeff(&index) > 0.0)
    up = std::string(down[index] > 0.0 ? "-" : "") + static_cast<char>('x' + index);
  up = interview.answer({"up", "Which axis of the source points up?", up, kAxisNames});
  const std::string forward = interview.answer(
      {"forward", "Which axis of the source points forward?", up.back() == 'x' ? "y" : "x", kAxisNames});
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
