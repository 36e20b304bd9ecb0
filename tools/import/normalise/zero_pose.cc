#include "tools/import/normalise/zero_pose.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/import/decide/role_joints.h"
#include "tools/import/normalise/sole_line.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

// An axis beside an axis of the base by less is a matter of rounding, which align_robot() snaps.
constexpr double kAxisTolerance_rad = 0.5 * kRadPerDegree;
// A knee a little in front of the hip is how legs are built; one that is further off means bent legs.
constexpr double kBentTolerance_rad = 10.0 * kRadPerDegree;

// The signed angle about `axis` that turns `from` to `to`, both projected on the plane of rotation. Nothing
// if one of them is along the axis.
std::optional<double> angle_between(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  const Vector3d a = from - axis * axis.dot(from);
  const Vector3d b = to - axis * axis.dot(to);
  if (a.norm() < 1e-6 || b.norm() < 1e-6) return std::nullopt;
  return std::atan2(axis.dot(a.cross(b)), a.dot(b));
}

// The direction that a joint straightens: the axis of a joint that it carries, or the way to the next anchor.
// The first target of a role whose joint it carries counts: hips and ankles have their joints in any order.
struct Target {
  std::string_view role;
  std::string_view axis_of;  // make this joint's axis parallel to `along`
  Vector3d along;
  std::string_view point_of;  // bring this joint's anchor below
};

const std::vector<Target>& targets() {
  static const std::vector<Target> table{
      {"hip_yaw", "hip_pitch", Vector3d::UnitY(), ""},
      {"hip_yaw", "knee", Vector3d::UnitY(), ""},
      {"hip_roll", "hip_pitch", Vector3d::UnitY(), ""},
      {"hip_roll", "knee", Vector3d::UnitY(), ""},
      {"hip_pitch", "", Vector3d::Zero(), "knee"},
      {"knee", "", Vector3d::Zero(), "ankle_pitch"},
      {"ankle_pitch", "ankle_roll", Vector3d::UnitX(), ""},
      {"ankle_roll", "ankle_pitch", Vector3d::UnitY(), ""},
      {"shoulder_pitch", "shoulder_roll", Vector3d::UnitX(), ""},
      {"shoulder_roll", "", Vector3d::Zero(), "elbow"},
      {"elbow", "", Vector3d::Zero(), "tip"},
      {"head_pan", "head_tilt", Vector3d::UnitY(), ""},
  };
  return table;
}

class Straightener {
 public:
  Straightener(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR, const ImportDecisions& decisions)
      : robot_(robot), R_MR_(R_MR), decisions_(decisions), angles_rad_(robot.joints.size(), 0.0) {
    update();
  }

  // Sets the angle of a joint by its name in robot.sdf.
  void set(const std::string& name, double angle_rad) {
    angles_rad_[static_cast<std::size_t>(*index_of(name))] = angle_rad;
    update();
  }
  void straighten(const std::string& name) {
    const auto joint = index_of(name);
    const RoleJoint* const role = find_role(name);
    if (!joint || role == nullptr) return;
    const std::string side = name.substr(0, name.size() - role->name.size());
    for (const Target& target : targets()) {
      if (target.role != role->name) continue;
      const auto next = index_of(side + std::string(target.axis_of));
      if (!target.axis_of.empty() && (!next || !carries(*joint, *next))) continue;
      turn(name, side, target);
      break;
    }
    if (role->name == "ankle_pitch") level_sole(*joint, name, side);
  }

  // Moves the angle of a joint into its range: elbows and knees of some robots end before they are straight.
  void keep_within_range(const std::string& name) {
    const auto index = static_cast<std::size_t>(*index_of(name));
    const ImportedJoint& bounded = robot_.joints[index];
    if (!bounded.lower_rad || !bounded.upper_rad) return;
    constexpr double kInside_rad = 1e-6 * kRadPerDegree;  // more than the rounding of the file
    const double lower_rad = *bounded.lower_rad + kInside_rad;
    const double upper_rad = std::max(lower_rad, *bounded.upper_rad - kInside_rad);
    const double further_rad = std::clamp(angles_rad_[index], lower_rad, upper_rad) - angles_rad_[index];
    if (std::abs(further_rad) > 2.0 * kInside_rad) set_rounded(name, static_cast<int>(index), further_rad);
  }

  std::optional<int> index_of(const std::string& name) const {
    const auto source = decisions_.joints.find(name);
    return source == decisions_.joints.end() ? std::nullopt : robot_.find_joint(source->second);
  }
  const std::vector<double>& angles_rad() const { return angles_rad_; }

 private:
  void update() {
    X_ML_ = link_poses(robot_, angles_rad_);
    for (Eigen::Isometry3d& pose : X_ML_) pose = R_MR_ * pose;
  }
  bool carries(int joint, int other) const {
    for (int at = other; at >= 0; at = joint_of(robot_, this->joint(at).parent))
      if (at == joint) return true;
    return false;
  }
  const ImportedJoint& joint(int index) const { return robot_.joints[static_cast<std::size_t>(index)]; }
  Vector3d anchor(int index) const {
    return X_ML_[static_cast<std::size_t>(joint(index).child)].translation();
  }
  Vector3d axis(int index) const {
    return X_ML_[static_cast<std::size_t>(joint(index).child)].linear() * joint(index).axis_L;
  }

  // The axis of the ankle's roll may be inclined to the sole, which then decides.
  void level_sole(int ankle, const std::string& name, const std::string& side) {
    constexpr double kLevel_rad = 1.0 * kRadPerDegree;
    const auto roll = index_of(side + "ankle_roll");
    const int foot = joint(roll && carries(ankle, *roll) ? *roll : ankle).child;
    const Vector3d forward = axis(ankle).cross(Vector3d::UnitZ()) * (axis(ankle).y() < 0.0 ? -1.0 : 1.0);
    if (forward.norm() < 0.5) return;
    const ImportedLink& link = robot_.links[static_cast<std::size_t>(foot)];
    std::vector<Eigen::Vector2d> points;
    for (const ImportedShape& shape : link.collisions.empty() ? link.visuals : link.collisions) {
      if (!shape.surface) continue;
      const Eigen::Isometry3d X_MG = X_ML_[static_cast<std::size_t>(foot)] * shape.X_LG;
      for (const Eigen::Vector3f& vertex : shape.surface->vertices_m) {
        const Vector3d point = X_MG * vertex.cast<double>();
        points.emplace_back(forward.normalized().dot(point), point.z());
      }
    }
    const auto sole = sole_line(std::move(points));
    if (!sole) return;
    const auto angle_rad =
        angle_between(axis(ankle), sole->x() * forward.normalized() + sole->y() * Vector3d::UnitZ(), forward);
    if (angle_rad && std::abs(*angle_rad) > kLevel_rad) set_rounded(name, ankle, *angle_rad);
  }

  void turn(const std::string& name, const std::string& side, const Target& target) {
    const int at = *index_of(name);
    std::optional<double> angle_rad;
    double tolerance_rad = kBentTolerance_rad;
    if (!target.axis_of.empty()) {
      const auto next = index_of(side + std::string(target.axis_of));
      if (!next) return;
      angle_rad = axis_angle(at, *next, target.along);
      tolerance_rad = kAxisTolerance_rad;
    } else {
      const auto end = end_of(at, side, target.point_of);
      if (!end) return;
      angle_rad = angle_between(axis(at), *end - anchor(at), -Vector3d::UnitZ());
    }
    if (angle_rad && std::abs(*angle_rad) > tolerance_rad) set_rounded(name, at, *angle_rad);
  }

  // Turns a joint further; rounded, so that import.yaml gives the same pose.
  void set_rounded(const std::string& name, int at, double further_rad) {
    constexpr double kRounding_deg = 1e-6;
    const double zero_deg = kDegreesPerRad * (angles_rad_[static_cast<std::size_t>(at)] + further_rad);
    set(name, kRadPerDegree * (std::round(zero_deg / kRounding_deg) * kRounding_deg));
  }

  // Either direction of the other axis will do; the one that is nearer, or, where both are far, the one after
  // which the limb hangs lower.
  std::optional<double> axis_angle(int at, int next, const Vector3d& along) const {
    constexpr double kFar_rad = 60.0 * kRadPerDegree;
    const auto one = angle_between(axis(at), axis(next), along);
    const auto other = angle_between(axis(at), axis(next), -along);
    if (!one || !other) return std::nullopt;
    const double nearer = std::abs(*one) <= std::abs(*other) ? *one : *other;
    if (std::abs(nearer) < kFar_rad) return nearer;
    const Vector3d limb = tip(at) - anchor(at);
    const auto height = [&](double angle_rad) { return (Eigen::AngleAxisd(angle_rad, axis(at)) * limb).z(); };
    return height(*one) <= height(*other) ? *one : *other;
  }

  std::optional<Vector3d> end_of(int at, const std::string& side, std::string_view point) const {
    if (point == "tip") return tip(at);
    const auto next = index_of(side + std::string(point));
    if (next) return anchor(*next);
    return std::nullopt;
  }

  // The place of the limb's shapes that is farthest from the joint; of its mass without shapes.
  Vector3d tip(int at) const {
    const Eigen::Isometry3d& X_ML = X_ML_[static_cast<std::size_t>(joint(at).child)];
    const ImportedLink& link = robot_.links[static_cast<std::size_t>(joint(at).child)];
    const LinkBox box = box_of(link);
    const Eigen::AlignedBox3d& extent = box.extent_G;
    if (extent.isEmpty()) return X_ML * link.p_LCom_L;
    // The middle of the face that is farthest away, as the axis of a forearm leads there.
    Vector3d far = extent.center();
    for (int i = 0; i < 6; ++i) {
      Vector3d face = extent.center();
      face[i / 2] = i % 2 == 0 ? extent.min()[i / 2] : extent.max()[i / 2];
      if (face.norm() > far.norm()) far = face;
    }
    return X_ML * (box.R_LG * far);
  }

  const ImportedRobot& robot_;
  const Eigen::Matrix3d& R_MR_;
  const ImportDecisions& decisions_;
  std::vector<double> angles_rad_;
  std::vector<Eigen::Isometry3d> X_ML_;
};

}  // namespace

std::vector<double> decide_zero_pose(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR,
                                     Interview& interview, ImportReport& report) {
  Straightener straightener(robot, R_MR, interview.taken);
  const bool is_wanted =
      interview.yes({"straighten",
                     "Is joint zero the upright pose with hanging arms, whatever the source's zero is?",
                     "yes",
                     {}});
  // Role names are ordered from the trunk outwards in each limb. A follower has a zero of its own: what the
  // two zeros differ by becomes the offset.
  for (const std::string& name : role_names()) {
    const auto index = straightener.index_of(name);
    if (!index) continue;
    const auto given = interview.given().zero_deg.find(name);
    if (given != interview.given().zero_deg.end()) {
      straightener.set(name, kRadPerDegree * given->second);
    } else if (is_wanted) {
      straightener.straighten(name);
      straightener.keep_within_range(name);
    }
    const double angle_deg = kDegreesPerRad * straightener.angles_rad()[static_cast<std::size_t>(*index)];
    if (angle_deg == 0.0) continue;
    interview.taken.zero_deg[name] = std::round(1e6 * angle_deg) / 1e6;
    report.normalised.push_back(fmt::format("{}: zero is at {:.2f} deg of {}", name, angle_deg,
                                            one_line(robot.joints[static_cast<std::size_t>(*index)].name)));
  }
  return straightener.angles_rad();
}

}  // namespace koboshi::tools
