#include "tools/import/decide/roles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <span>
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
    std::vector<Chain> chains = chains_of(robot_, R_MR_);
    // A gripper's fingers share a wrist: the longest chain below a joint is the limb.
    keep_one_chain_per_limb(chains, middle_of(chains));
    remove_shared(chains, robot_, R_MR_);
    if (chains.size() < 2) return {};
    const double middle_y = middle_of(chains);
    name_pair(chains, middle_y, kLegRoles, &Chain::last);
    name_pair(chains, middle_y, kArmRoles, nullptr);
    name_head(chains, middle_y);
    return std::move(roles_);
  }

 private:
  static constexpr double kMiddle_m = 0.02;  // to either side of the mid-plane

  void keep_one_chain_per_limb(std::vector<Chain>& chains, double middle_y) const {
    std::ranges::stable_sort(
        chains, [](const Chain& a, const Chain& b) { return a.joints.size() > b.joints.size(); });
    std::vector<Chain> kept;
    for (const Chain& chain : chains) {
      // Chains that part after three or more joints are one limb, unless they part in the mid-plane: the
      // first joints then are a waist, whose limbs part to the sides.
      const bool is_branch = std::ranges::any_of(kept, [&](const Chain& other) {
        std::size_t shared = 0;
        while (shared < std::min(chain.joints.size(), other.joints.size()) &&
               chain.joints[shared] == other.joints[shared])
          ++shared;
        return shared >= 3 && std::abs(anchor(chain.joints[shared - 1]).y() - middle_y) > kMiddle_m;
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
    std::vector<std::size_t> joints = chain.joints;
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

}  // namespace

namespace {

// Forward is across the line between the legs: the axis x (REP-103), unless the legs are beside each other
// along it. Its direction then is that in which the feet are longer.
std::string usual_forward(const ImportedRobot& robot, const std::vector<Chain>& chains,
                          const std::string& up) {
  const std::string usual = up.back() == 'x' ? "y" : "x";
  const Vector3d z = axis_of(up);
  std::vector<const Chain*> lowest;
  for (const Chain& chain : chains) lowest.push_back(&chain);
  std::ranges::stable_sort(lowest,
                           [&](const Chain* a, const Chain* b) { return a->last.dot(z) < b->last.dot(z); });
  if (lowest.size() < 2) return usual;
  const Vector3d between = lowest[0]->first - lowest[1]->first;
  const Vector3d beside = between - z * z.dot(between);
  int across = 0;
  beside.cwiseAbs().maxCoeff(&across);
  if (beside.norm() < 0.01 || across != usual.back() - 'x') return usual;
  const int index = 3 - across - (up.back() - 'x');
  const std::vector<Eigen::Isometry3d> X_RL = link_poses(robot);
  double ahead_m = 0.0;
  for (const std::size_t leg : {0U, 1U}) {
    const auto foot = static_cast<std::size_t>(robot.joints[lowest[leg]->joints.back()].child);
    const Eigen::AlignedBox3d extent = extent_of(robot.links[foot]);
    if (extent.isEmpty()) continue;
    ahead_m += (X_RL[foot] * extent.center() - X_RL[foot].translation())[index];
  }
  return std::string(ahead_m < 0.0 ? "-" : "") + static_cast<char>('x' + index);
}

}  // namespace

Eigen::Matrix3d decide_axes(const ImportedRobot& robot, Interview& interview) {
  // The two chains with the most joints are the legs of most robots, and hang down from their first joint:
  // the root may be a place on the ground.
  std::vector<Chain> chains = chains_of(robot, Eigen::Matrix3d::Identity());
  remove_shared(chains, robot, Eigen::Matrix3d::Identity());
  std::ranges::stable_sort(chains, [](const Chain& a, const Chain& b) {
    return std::pair(a.joints.size(), a.length().norm()) > std::pair(b.joints.size(), b.length().norm());
  });
  Vector3d down = Vector3d::Zero();
  for (std::size_t i = 0; i < std::min<std::size_t>(2, chains.size()); ++i) down += chains[i].length();
  int index = 2;
  std::string up = "z";
  // Arms that stand out to both sides cancel each other, and say nothing.
  constexpr double kClear = 0.3;
  double longest_m = 0.0;
  if (!chains.empty()) longest_m = chains.front().length().norm();
  if (longest_m > 0.0 && down.cwiseAbs().maxCoeff(&index) > kClear * longest_m)
    up = std::string(down[index] > 0.0 ? "-" : "") + static_cast<char>('x' + index);
  up = interview.answer({"up", "Which axis of the source points up?", up, kAxisNames});
  const std::string forward = interview.answer(
      {"forward", "Which axis of the source points forward?", usual_forward(robot, chains, up), kAxisNames});
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
  if (!roles.contains("left_knee") || !roles.contains("right_knee"))
    report.warnings.push_back(
        "no two legs found: import.md shows which axes were taken for up and forward, and joints in "
        "import.yaml "
        "names the firmware's joints");
  // Joints of one side only have no role: the firmware needs both.
  for (auto entry = roles.begin(); entry != roles.end();)
    entry = roles.contains(mirrored_name(entry->first)) ? std::next(entry) : roles.erase(entry);
  interview.taken.joints = std::move(roles);
}

}  // namespace koboshi::tools
