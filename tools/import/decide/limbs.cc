#include "tools/import/decide/limbs.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

// Poses of the links in the axes of M, about the root's origin.
std::vector<Eigen::Isometry3d> turned_poses(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR) {
  std::vector<Eigen::Isometry3d> poses = link_poses(robot);
  for (Eigen::Isometry3d& pose : poses) pose = R_MR * pose;
  return poses;
}

class LimbFinder {
 public:
  LimbFinder(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR)
      : robot_(robot), X_ML_(turned_poses(robot, R_MR)) {
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      corners_M_.push_back(corners(i));
      body_.extend(X_ML_[i].translation());
      for (const Vector3d& corner : corners_M_[i]) body_.extend(corner);
    }
  }

  std::vector<Limb> find() const {
    std::vector<Limb> limbs = kept_chains();
    std::map<std::size_t, int> users;
    for (const Limb& limb : limbs)
      for (const std::size_t joint : limb.joints) ++users[joint];
    for (Limb& limb : limbs) {
      std::erase_if(limb.joints, [&](std::size_t joint) { return users[joint] > 1; });
      if (!limb.joints.empty()) limb.first_m = anchor(limb.joints.front());
    }
    std::erase_if(limbs, [](const Limb& limb) { return limb.joints.empty(); });
    return limbs;
  }

 private:
  Vector3d anchor(std::size_t joint) const {
    return X_ML_[static_cast<std::size_t>(robot_.joints[joint].child)].translation();
  }
  std::vector<Vector3d> corners(std::size_t link) const {
    const LinkBox box = box_of(robot_.links[link]);
    std::vector<Vector3d> points;
    if (box.extent_G.isEmpty()) return points;
    for (int corner = 0; corner < 8; ++corner)
      points.push_back(X_ML_[link] * (box.R_LG * box.extent_G.corner(
                                                     static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
    return points;
  }

  // Joints from the root to each end of the tree, longest first.
  std::vector<Limb> chains() const {
    std::vector<bool> is_parent(robot_.links.size(), false);
    for (const ImportedJoint& joint : robot_.joints) is_parent[static_cast<std::size_t>(joint.parent)] = true;
    std::vector<Limb> chains;
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      if (is_parent[static_cast<std::size_t>(robot_.joints[i].child)]) continue;
      Limb chain;
      for (int at = static_cast<int>(i); at >= 0;
           at = joint_of(robot_, robot_.joints[static_cast<std::size_t>(at)].parent))
        chain.joints.insert(chain.joints.begin(), static_cast<std::size_t>(at));
      chain.first_m = anchor(chain.joints.front());
      chain.last_m = anchor(chain.joints.back());
      chains.push_back(std::move(chain));
    }
    std::ranges::stable_sort(chains,
                             [](const Limb& a, const Limb& b) { return a.joints.size() > b.joints.size(); });
    return chains;
  }

  // Chains that part after three or more joints are one limb with fingers, unless arms part there.
  std::vector<Limb> kept_chains() const {
    std::vector<Limb> kept;
    for (const Limb& chain : chains()) {
      const bool is_finger = std::ranges::any_of(kept, [&](const Limb& other) {
        std::size_t shared = 0;
        while (shared < std::min(chain.joints.size(), other.joints.size()) &&
               chain.joints[shared] == other.joints[shared])
          ++shared;
        return shared >= 3 && !is_trunk(robot_.joints[chain.joints[shared - 1]].child);
      });
      if (!is_finger) kept.push_back(chain);
    }
    return kept;
  }

  // A link that carries two limbs which reach far, as those of a hand do not.
  bool is_trunk(int link) const {
    constexpr double kFar = 0.2;  // of the robot's diagonal
    const auto limbs = std::ranges::count_if(robot_.joints, [&](const ImportedJoint& joint) {
      return joint.parent == link && reach_m(joint.child) > kFar * body_.diagonal().norm();
    });
    return limbs >= 2;
  }

  // How far the parts beyond a joint reach from it.
  double reach_m(int link) const {
    const Vector3d from = X_ML_[static_cast<std::size_t>(link)].translation();
    double reach = 0.0;
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      int at = static_cast<int>(i);
      while (at != link) {
        const int joint = joint_of(robot_, at);
        if (joint < 0) break;
        at = robot_.joints[static_cast<std::size_t>(joint)].parent;
      }
      if (at != link) continue;
      reach = std::max(reach, (X_ML_[i].translation() - from).norm());
      for (const Vector3d& corner : corners_M_[i]) reach = std::max(reach, (corner - from).norm());
    }
    return reach;
  }

  const ImportedRobot& robot_;
  std::vector<Eigen::Isometry3d> X_ML_;
  std::vector<std::vector<Vector3d>> corners_M_{};  // of the links' boxes
  Eigen::AlignedBox3d body_;
};

// Two limbs with as many joints and of about one length.
bool are_pair(const Limb& one, const Limb& other) {
  constexpr double kSameLength = 0.1;
  const double longer_m = std::max(one.length_m().norm(), other.length_m().norm());
  return one.joints.size() == other.joints.size() &&
         std::abs(one.length_m().norm() - other.length_m().norm()) <= kSameLength * longer_m;
}

bool hangs(const Limb& limb, const Vector3d& up) {
  constexpr double kSteep = 0.7;  // 45 degrees
  return -limb.length_m().dot(up) > kSteep * limb.length_m().norm() && limb.length_m().norm() > 0.0;
}

// The two legs of a body that points up along `up`; nothing if no pair of limbs hangs lowest.
std::optional<std::pair<const Limb*, const Limb*>> legs_below(const std::vector<Limb>& limbs,
                                                              const Vector3d& up) {
  constexpr std::size_t kFewestJoints = 3;
  const auto end_of = [&up](const Limb& limb) { return limb.last_m.dot(up); };
  const auto lowest = std::ranges::min_element(limbs, {}, end_of);
  if (lowest == limbs.end() || lowest->joints.size() < kFewestJoints || !hangs(*lowest, up)) return {};
  for (const Limb& other : limbs)
    if (&other != &*lowest && are_pair(*lowest, other) && hangs(other, up) &&
        end_of(other) - end_of(*lowest) < 0.1 * lowest->length_m().norm())
      return std::pair(&*lowest, &other);
  return {};
}

bool is_letter_of_side(char letter, char side) {
  return std::tolower(static_cast<unsigned char>(letter)) == side;
}

// A figure that tells the front of a pair of legs from its back: positive if `forward` is the front.
class FrontEvidence {
 public:
  FrontEvidence(const ImportedRobot& robot, const Vector3d& up, const Vector3d& forward)
      : robot_(robot), X_RL_(link_poses(robot)), up_(up), forward_(forward) {}

  double of_names(const Limb& one, const Limb& other) const {
    int left = 0;
    for (std::size_t i = 0; i < one.joints.size() && left == 0; ++i)
      left = side_in_names(robot_.joints[one.joints[i]].name, robot_.joints[other.joints[i]].name);
    const Vector3d to_left = left * (one.first_m + one.last_m - other.first_m - other.last_m);
    const double share = to_left.dot(up_.cross(forward_));
    return share == 0.0 ? 0.0 : std::copysign(1.0, share);
  }

  // Feet reach further forward from the ankle than backward.
  double of_foot(const Limb& leg) const {
    const auto link = static_cast<std::size_t>(robot_.joints[leg.joints.back()].child);
    const LinkBox box = box_of(robot_.links[link]);
    if (box.extent_G.isEmpty()) return 0.0;
    constexpr double kClear = 0.05;  // of the leg's length
    const double before_m = (X_RL_[link] * box.center_L() - leg.last_m).dot(forward_);
    return std::abs(before_m) < kClear * leg.length_m().norm() ? 0.0 : std::copysign(1.0, before_m);
  }

  // Knees bend backward: the joint across the leg that is nearest to the middle between hip and ankle.
  double of_knee(const Limb& leg) const {
    constexpr double kAcross = 0.9;
    const Vector3d middle_m = 0.5 * (leg.first_m + leg.last_m);
    double nearest_m = 0.25 * leg.length_m().norm();
    double evidence = 0.0;
    for (const std::size_t index : leg.joints) {
      const ImportedJoint& joint = robot_.joints[index];
      const Eigen::Isometry3d& X_RL = X_RL_[static_cast<std::size_t>(joint.child)];
      const Vector3d axis = X_RL.linear() * joint.axis_L;
      const double off_m = std::abs((X_RL.translation() - middle_m).dot(up_));
      if (std::abs(axis.dot(up_.cross(forward_))) < kAcross || off_m >= nearest_m) continue;
      nearest_m = off_m;
      const double middle_rad = 0.5 * (joint.lower_rad.value_or(0.0) + joint.upper_rad.value_or(0.0));
      const double shank_moves = (middle_rad * axis.cross(-up_)).dot(forward_);
      constexpr double kClear_rad = 0.3;
      evidence = std::abs(shank_moves) < kClear_rad ? 0.0 : std::copysign(1.0, -shank_moves);
    }
    return evidence;
  }

 private:
  const ImportedRobot& robot_;
  std::vector<Eigen::Isometry3d> X_RL_;
  Vector3d up_;
  Vector3d forward_;
};

}  // namespace

int side_in_names(const std::string& one, const std::string& other) {
  const auto lower = [](std::string text) {
    for (char& letter : text) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return text;
  };
  const auto swapped = [&lower](const std::string& text, const std::string& side, const std::string& by) {
    std::string name = lower(text);
    const std::size_t at = name.find(side);
    return at == std::string::npos ? std::string() : name.replace(at, side.size(), by);
  };
  if (swapped(one, "left", "right") == lower(other)) return 1;
  if (swapped(one, "right", "left") == lower(other)) return -1;
  if (one.size() != other.size()) return 0;
  const auto [in_one, in_other] = std::ranges::mismatch(one, other);
  if (in_one == one.end() || !std::equal(in_one + 1, one.end(), in_other + 1, other.end())) return 0;
  if (is_letter_of_side(*in_one, 'l') && is_letter_of_side(*in_other, 'r')) return 1;
  return is_letter_of_side(*in_one, 'r') && is_letter_of_side(*in_other, 'l') ? -1 : 0;
}

std::vector<Limb> limbs_of(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR) {
  return LimbFinder(robot, R_MR).find();
}

Vector3d find_up(const std::vector<Limb>& limbs) {
  const std::array<Vector3d, 6> axes{Vector3d::UnitZ(),  Vector3d::UnitY(),  Vector3d::UnitX(),
                                     -Vector3d::UnitZ(), -Vector3d::UnitY(), -Vector3d::UnitX()};
  for (const Vector3d& up : axes)
    if (legs_below(limbs, up)) return up;
  // The two limbs with the most joints are the legs of most robots.
  std::vector<Limb> longest = limbs;
  std::ranges::stable_sort(longest, [](const Limb& a, const Limb& b) {
    return std::pair(a.joints.size(), a.length_m().norm()) > std::pair(b.joints.size(), b.length_m().norm());
  });
  Vector3d down = Vector3d::Zero();
  for (std::size_t i = 0; i < std::min<std::size_t>(2, longest.size()); ++i) down += longest[i].length_m();
  int index = 2;
  if (down.norm() == 0.0) return Vector3d::UnitZ();
  down.cwiseAbs().maxCoeff(&index);
  return std::copysign(1.0, -down[index]) * Vector3d::Unit(index);
}

Vector3d find_forward(const ImportedRobot& robot, const std::vector<Limb>& limbs, const Vector3d& up) {
  const Vector3d usual = std::abs(up.x()) > 0.5 ? Vector3d::UnitY() : Vector3d::UnitX();
  const auto legs = legs_below(limbs, up);
  if (!legs) return usual;
  const auto& [one, other] = *legs;
  const Vector3d apart = one->first_m + one->last_m - other->first_m - other->last_m;
  int beside = 0;
  if ((apart - apart.dot(up) * up).cwiseAbs().maxCoeff(&beside) == 0.0) return usual;
  const Vector3d forward = up.cross(Vector3d::Unit(beside)).cwiseAbs();
  const FrontEvidence evidence(robot, up, forward);
  // Names that differ by a side are meant so; a foot or a range may be symmetric, or drawn for a bird.
  constexpr double kNames = 4.0;
  constexpr double kFoot = 1.0;
  constexpr double kKnee = 0.5;
  double sum = kNames * evidence.of_names(*one, *other);
  for (const Limb* leg : {one, other}) sum += kFoot * evidence.of_foot(*leg) + kKnee * evidence.of_knee(*leg);
  return sum < 0.0 ? Vector3d(-forward) : forward;
}

}  // namespace koboshi::tools
