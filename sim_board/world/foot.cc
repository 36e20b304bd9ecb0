#include "sim_board/world/foot.h"

#include <algorithm>
#include <limits>

#include "sim_board/world/ground_truth.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

bool is_of_ground(const Contact& contact, const Foot& foot) {
  return contact.link == foot.link && contact.other_link < 0;
}

Foot make_foot(const RobotDescription& robot, int joint, const Isometry3d& X_LSole) {
  Foot foot;
  foot.link = robot.joints.at(static_cast<std::size_t>(joint)).child;
  foot.X_LSole = X_LSole;
  for (const BoxDescription& box : robot.links.at(static_cast<std::size_t>(foot.link)).collisions) {
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        foot.corners_L.push_back(box.X_LG * Vector3d(x, y, -0.5).cwiseProduct(box.size_m));
      }
    }
  }
  return foot;
}

// The foot below the last joint of a leg.
std::optional<Foot> foot_below(const RobotDescription& robot, hal::Side side) {
  const auto index = robot.foot_joint(side);
  if (!index) return std::nullopt;
  const JointDescription& joint = robot.joints.at(static_cast<std::size_t>(*index));
  const LinkDescription& link = robot.links.at(static_cast<std::size_t>(joint.child));
  if (link.collisions.empty()) return std::nullopt;
  double lowest_m = std::numeric_limits<double>::infinity();
  for (const BoxDescription& box : link.collisions) {
    const Isometry3d X_MG = link.X_ML * box.X_LG;
    const double half_m = X_MG.linear().row(2).cwiseAbs().dot(box.size_m.transpose()) / 2;
    lowest_m = std::min(lowest_m, X_MG.translation().z() - half_m);
  }
  const Vector3d p_MSole(joint.p_MJ.x(), joint.p_MJ.y(), lowest_m);
  return make_foot(robot, *index, link.X_ML.inverse() * Eigen::Translation3d(p_MSole));
}

}  // namespace

Foot foot_of(const RobotDescription& robot, const AnkleSensorDescription& sensor) {
  return make_foot(robot, sensor.joint,
                   sensor.X_LS * Eigen::Translation3d(0.0, 0.0, -sensor.height_above_sole_m));
}

std::array<std::optional<Foot>, 2> feet_of(const RobotDescription& robot) {
  std::array<std::optional<Foot>, 2> feet;
  feet[0] = robot.left_ankle ? foot_of(robot, *robot.left_ankle) : foot_below(robot, hal::Side::kLeft);
  feet[1] = robot.right_ankle ? foot_of(robot, *robot.right_ankle) : foot_below(robot, hal::Side::kRight);
  return feet;
}

FootPressure foot_pressure(const RobotDescription& robot, const Foot& foot, const World& world) {
  const Isometry3d X_WSole = pose_before_step(robot, world, foot.link) * foot.X_LSole;
  const Vector3d normal_W = X_WSole.linear().col(2);
  FootPressure pressure;
  Vector3d moment_W = Vector3d::Zero();  // of the normal forces: sum of force times position
  for (const Contact& contact : world.contacts()) {
    if (!is_of_ground(contact, foot)) continue;
    const double force_N = normal_W.dot(contact.f_W);
    pressure.load_N += force_N;
    moment_W += force_N * contact.p_W;
  }
  const Vector3d p_W = pressure.load_N > 0.0 ? Vector3d(moment_W / pressure.load_N) : X_WSole.translation();
  pressure.zmp_S_m = (X_WSole.inverse() * p_W).head<2>();
  pressure.p_WZmp_W = X_WSole * Vector3d(pressure.zmp_S_m.x(), pressure.zmp_S_m.y(), 0.0);
  return pressure;
}

void add_support_points(const Foot& foot, const World& world, const RobotDescription& robot,
                        const GroundDescription& ground, std::vector<Vector3d>& points_W) {
  const Isometry3d X_WL = pose_before_step(robot, world, foot.link);
  for (const Vector3d& corner_L : foot.corners_L) {
    const Vector3d corner_W = X_WL * corner_L;
    double height_m = std::numeric_limits<double>::infinity();
    for (const Contact& contact : world.contacts()) {
      if (!is_of_ground(contact, foot)) continue;
      height_m = std::min(height_m, contact.n_W.dot(corner_W - contact.p_W));
    }
    if (height_m >= kTouching_m) continue;
    if (ground.is_only_a_plane() || height_above(ground, corner_W) < kTouching_m)
      points_W.push_back(corner_W);
  }
  if (ground.is_only_a_plane()) return;
  for (const Contact& contact : world.contacts()) {
    if (!is_of_ground(contact, foot)) continue;
    const auto near_contact = [&](const Vector3d& corner_L) {
      return (X_WL * corner_L - contact.p_W).norm() < kTouching_m;
    };
    if (std::ranges::none_of(foot.corners_L, near_contact)) points_W.push_back(contact.p_W);
  }
}

}  // namespace koboshi::sim_board
