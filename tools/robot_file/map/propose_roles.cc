#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim_board/description/schema/roles.h"
#include "tools/robot_file/map/role_map.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;
using sim_board::RobotDescription;

// By hand: an axis within 25 degrees of a coordinate axis counts as that one.
constexpr double kAlongAxis = 0.9;
// By hand: ends within this share of the robot's extent are in the middle, or mirror images.
constexpr double kSamePlace = 0.05;

// A chain of joints from the base to a link that carries no other.
struct Chain {
  std::vector<std::size_t> joints{};
  int end = 0;                        // link
  Vector3d tip_M = Vector3d::Zero();  // its centre of mass
};

char axis_letter(const sim_board::JointDescription& joint) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(joint.axis_M[i]) >= kAlongAxis) return "xyz"[i];
  return '?';
}

class Proposal {
 public:
  explicit Proposal(const RobotDescription& robot) : robot_(robot) {
    map_.joints.resize(robot.joints.size());
  }

  RoleMap make() {
    find_chains();
    find_extent();
    if (const auto legs = take_pair(/*are_legs=*/true)) {
      name_pair(*legs, [this](const std::string& side, const auto& joints) { name_leg(side, joints); });
      for (std::size_t side = 0; side < 2; ++side) map_.feet[side] = (*legs)[side].end;
    }
    if (const auto arms = take_pair(/*are_legs=*/false))
      name_pair(*arms, [this](const std::string& side, const auto& joints) { name_arm(side, joints); });
    name_head();
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      if (!robot_.joints[i].stated_role.empty()) assign(i, robot_.joints[i].stated_role);
    }
    find_mirrors();
    return std::move(map_);
  }

 private:
  using Pair = std::array<Chain, 2>;  // left, right

  const sim_board::JointDescription& joint(std::size_t i) const { return robot_.joints[i]; }

  void find_chains() {
    std::vector<int> carrier(robot_.links.size(), -1);
    std::vector<bool> carries(robot_.links.size(), false);
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      carrier[static_cast<std::size_t>(joint(i).child)] = static_cast<int>(i);
      carries[static_cast<std::size_t>(joint(i).parent)] = true;
    }
    // A follower has its role by its leader, and counts as rigid here.
    for (std::size_t round = 0; round < robot_.followers.size(); ++round) {
      for (const sim_board::FollowerDescription& follower : robot_.followers) {
        carrier[static_cast<std::size_t>(follower.hinge.child)] =
            carrier[static_cast<std::size_t>(follower.hinge.parent)];
        carries[static_cast<std::size_t>(follower.hinge.parent)] = true;
      }
    }
    for (std::size_t link = 0; link < robot_.links.size(); ++link) {
      Chain chain{.end = static_cast<int>(link),
                  .tip_M = robot_.links[link].X_ML * robot_.links[link].p_LCom_L};
      for (int above = carrier[link]; above >= 0;) {
        const auto index = static_cast<std::size_t>(above);
        chain.joints.insert(chain.joints.begin(), index);
        map_.joints[index].carried_kg += robot_.links[link].mass_kg;
        above = carrier[static_cast<std::size_t>(joint(index).parent)];
      }
      if (!carries[link] && !chain.joints.empty()) chains_.push_back(std::move(chain));
    }
  }

  void find_extent() {
    Eigen::AlignedBox3d box;
    for (const sim_board::LinkDescription& link : robot_.links) box.extend(link.X_ML * link.p_LCom_L);
    for (const sim_board::JointDescription& one : robot_.joints) box.extend(one.p_MJ);
    extent_m_ = box.diagonal().norm();
  }

  double chain_mass(const Chain& chain) const { return map_.joints[chain.joints.front()].carried_kg; }

  // How far a chain is from the mirror image of another one, in m; a mass that differs counts as distance.
  double mirror_miss_m(const Chain& left, const Chain& right) const {
    const Vector3d image_M(right.tip_M.x(), -right.tip_M.y(), right.tip_M.z());
    const double masses = std::max(chain_mass(left), chain_mass(right));
    const double share = masses > 0.0 ? std::abs(chain_mass(left) - chain_mass(right)) / masses : 0.0;
    return (left.tip_M - image_M).norm() + kSamePlace * extent_m_ * share;
  }

  // The best pair of chains that are mirror images; they are taken from the list, and with them the chains
  // that begin with the same joints, such as fingers.
  std::optional<Pair> take_pair(bool are_legs) {
    const Chain* best[2] = {nullptr, nullptr};
    for (const Chain& left : chains_) {
      for (const Chain& right : chains_) {
        if (left.tip_M.y() <= right.tip_M.y() || &left == &right) continue;
        if (left.joints.size() != right.joints.size()) continue;
        if (mirror_miss_m(left, right) > kSamePlace * extent_m_) continue;
        const bool is_better = best[0] == nullptr || (are_legs ? left.tip_M.z() < best[0]->tip_M.z()
                                                               : left.joints.size() > best[0]->joints.size());
        if (!is_better) continue;
        best[0] = &left;
        best[1] = &right;
      }
    }
    if (best[0] == nullptr) return std::nullopt;
    Pair pair{*best[0], *best[1]};
    std::size_t common = 0;
    while (common < pair[0].joints.size() && pair[0].joints[common] == pair[1].joints[common]) ++common;
    for (std::size_t i = 0; i < common; ++i) name_waist(pair[0].joints[i]);
    for (Chain& chain : pair)
      chain.joints.erase(chain.joints.begin(), chain.joints.begin() + static_cast<std::ptrdiff_t>(common));
    std::erase_if(chains_, [&pair](const Chain& chain) {
      return std::ranges::any_of(pair, [&chain](const Chain& taken) {
        return !taken.joints.empty() &&
               std::ranges::find(chain.joints, taken.joints.front()) != chain.joints.end();
      });
    });
    return pair;
  }

  template <class Namer>
  void name_pair(const Pair& pair, const Namer& name) {
    name("left_", pair[0].joints);
    name("right_", pair[1].joints);
  }

  void name_leg(const std::string& side, const std::vector<std::size_t>& joints) {
    static constexpr std::array kPitch{"hip_pitch", "knee", "ankle_pitch"};
    std::size_t pitch = 0;
    for (const std::size_t i : joints) {
      const char axis = axis_letter(joint(i));
      if (axis == 'y' && pitch < kPitch.size()) assign_new(i, side + kPitch[pitch++]);
      if (axis == 'x') assign_new(i, side + (pitch < 2 ? "hip_roll" : "ankle_roll"));
      if (axis == 'z' && pitch < 2) assign_new(i, side + "hip_yaw");
    }
  }

  void name_arm(const std::string& side, const std::vector<std::size_t>& joints) {
    bool has_elbow = false;
    std::optional<std::size_t> upper_yaw;
    for (const std::size_t i : joints) {
      const char axis = axis_letter(joint(i));
      if (axis == '?') continue;
      const std::string turn = axis == 'x' ? "roll" : axis == 'y' ? "pitch" : "yaw";
      if (has_elbow) {
        assign_new(i, side + "wrist_" + turn);
      } else if (!is_taken(side + "shoulder_" + turn)) {
        assign_new(i, side + "shoulder_" + turn);
        if (axis == 'z') upper_yaw = i;
      } else {
        assign_new(i, side + "elbow");
        has_elbow = true;
      }
    }
    // Arms that are stretched to the sides bend about the vertical.
    if (!has_elbow && upper_yaw) assign(*upper_yaw, side + "elbow");
  }

  void name_waist(std::size_t i) {
    const char axis = axis_letter(joint(i));
    if (axis != '?') assign_new(i, axis == 'x' ? "waist_roll" : axis == 'y' ? "waist_pitch" : "waist_yaw");
  }

  void name_head() {
    const Chain* highest = nullptr;
    for (const Chain& chain : chains_) {
      if (std::abs(chain.tip_M.y()) > kSamePlace * extent_m_) continue;
      if (highest == nullptr || chain.tip_M.z() > highest->tip_M.z()) highest = &chain;
    }
    if (highest == nullptr) return;
    for (const std::size_t i : highest->joints) {
      if (!map_.joints[i].role.empty()) continue;
      if (axis_letter(joint(i)) == 'z') assign_new(i, "head_pan");
      if (axis_letter(joint(i)) == 'y') assign_new(i, "head_tilt");
    }
  }

  bool is_taken(const std::string& role) const {
    return std::ranges::any_of(map_.joints, [&](const RoleMap::Joint& one) { return one.role == role; });
  }
  void assign_new(std::size_t i, const std::string& role) {
    if (!is_taken(role) && map_.joints[i].role.empty()) map_.joints[i].role = role;
  }
  void assign(std::size_t i, const std::string& role) {
    for (RoleMap::Joint& one : map_.joints)
      if (one.role == role) one.role.clear();
    map_.joints[i].role = role;
  }

  // Joints without a role mirror each other if their anchors do.
  void find_mirrors() {
    for (std::size_t i = 0; i < map_.joints.size(); ++i) {
      map_.joints[i].mirror = i;
      if (!joint(i).stated_mirror.empty()) {
        map_.joints[i].mirror = static_cast<std::size_t>(robot_.mirror_of(static_cast<int>(i)));
        continue;
      }
      const std::string other = sim_board::other_side(map_.joints[i].role);
      double nearest_m = kSamePlace * extent_m_;
      for (std::size_t k = 0; k < map_.joints.size(); ++k) {
        if (map_.joints[i].role.empty() != map_.joints[k].role.empty()) continue;
        if (!other.empty()) {
          if (map_.joints[k].role == other) map_.joints[i].mirror = k;
          continue;
        }
        const Vector3d image_M(joint(k).p_MJ.x(), -joint(k).p_MJ.y(), joint(k).p_MJ.z());
        const Vector3d axis_M = sim_board::mirrored_axis(joint(k).axis_M);
        if (std::abs(axis_M.dot(joint(i).axis_M)) < 1.0 - 1e-9) continue;
        const double miss_m = (joint(i).p_MJ - image_M).norm();
        if (miss_m >= nearest_m) continue;
        nearest_m = miss_m;
        map_.joints[i].mirror = k;
      }
    }
  }

  const RobotDescription& robot_;
  RoleMap map_;
  std::vector<Chain> chains_;
  double extent_m_ = 0.0;
};

}  // namespace

RoleMap propose_roles(const RobotDescription& robot) { return Proposal(robot).make(); }

}  // namespace koboshi::tools
