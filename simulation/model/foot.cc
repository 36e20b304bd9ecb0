#include "simulation/model/foot.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/model/fields.h"

namespace koboshi::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using fixed::from_double;
using sim_board::RobotDescription;

constexpr double kFlat_m = 1e-4;  // corners up to this height above the lowest one count as ground contacts

// Returns the corners of the link's collision boxes at joint angle zero, in the base frame.
std::vector<Vector3d> corners_B(const RobotDescription& robot, const sim_board::LinkDescription& link) {
  const Isometry3d X_BL = robot.links.at(0).X_ML.inverse() * link.X_ML;
  std::vector<Vector3d> corners;
  for (const sim_board::BoxDescription& box : link.collisions) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
      corners.push_back(X_BL * box.X_LG * Vector3d(0.5 * sign.cwiseProduct(box.size_m)));
    }
  }
  return corners;
}

double lowest_z(const std::vector<Vector3d>& corners) {
  return std::min_element(corners.begin(), corners.end(),
                          [](const Vector3d& a, const Vector3d& b) { return a.z() < b.z(); })
      ->z();
}

// The joint that carries the foot.
struct Ankle {
  std::string name;
  int joint = -1;
  Vector3d p_BAnkle;
};

std::optional<Ankle> find_ankle(const RobotDescription& robot, hal::Side side) {
  const auto joint = robot.foot_joint(side);
  if (!joint) return std::nullopt;
  const sim_board::JointDescription& last = robot.joints.at(static_cast<std::size_t>(*joint));
  return Ankle{last.name, *joint, robot.links.at(0).X_ML.inverse() * last.p_MJ};
}

void set_sole(const RobotDescription& robot, const Ankle& ankle, robot::Foot& foot) {
  const int link = robot.joints[static_cast<std::size_t>(ankle.joint)].child;
  const sim_board::LinkDescription& described = robot.links.at(static_cast<std::size_t>(link));
  std::vector<Vector3d> corners = corners_B(robot, described);
  if (corners.empty()) {
    throw InputError(robot.file, described.line, "no collision box below " + ankle.name, "a sole");
  }
  const double sole_z = lowest_z(corners);
  std::erase_if(corners, [&](const Vector3d& corner) { return corner.z() > sole_z + kFlat_m; });
  const auto [back, front] = std::minmax_element(
      corners.begin(), corners.end(), [](const Vector3d& a, const Vector3d& b) { return a.x() < b.x(); });
  const auto [right, left] = std::minmax_element(
      corners.begin(), corners.end(), [](const Vector3d& a, const Vector3d& b) { return a.y() < b.y(); });
  foot.ankle_height = from_double<fixed::Length>(ankle.p_BAnkle.z() - sole_z);
  foot.back = from_double<fixed::Length>(back->x() - ankle.p_BAnkle.x());
  foot.front = from_double<fixed::Length>(front->x() - ankle.p_BAnkle.x());
  foot.right = from_double<fixed::Length>(right->y() - ankle.p_BAnkle.y());
  foot.left = from_double<fixed::Length>(left->y() - ankle.p_BAnkle.y());
}

void set_sensor(const RobotDescription& robot, const Ankle& ankle,
                const sim_board::AnkleSensorDescription& sensor, robot::Foot& foot) {
  const int link = robot.joints[static_cast<std::size_t>(ankle.joint)].child;
  const Isometry3d X_BS =
      robot.links.at(0).X_ML.inverse() * robot.links.at(static_cast<std::size_t>(link)).X_ML * sensor.X_LS;
  if (sensor.joint != ankle.joint || !X_BS.linear().isApprox(Eigen::Matrix3d::Identity(), 1e-6)) {
    throw InputError(robot.file, sensor.line, "the sensor " + sensor.name,
                     "a sensor on " + ankle.name + " with the foot's axes");
  }
  const Vector3d p_BSole = ankle.p_BAnkle - Vector3d(0, 0, fixed::to_double(foot.ankle_height));
  const Vector3d p_SoleS = X_BS.translation() - p_BSole;
  if (std::abs(p_SoleS.z() - sensor.height_above_sole_m) > kFlat_m) {
    throw InputError(robot.file, sensor.line,
                     "the sensor " + sensor.name + " at another height above the sole than it says",
                     std::to_string(p_SoleS.z()) + " m");
  }
  if (sensor.kind == hal::AnkleKind::kSixAxis) foot.sensor = fixed_position(p_SoleS);
  if (sensor.kind != hal::AnkleKind::kPressureCells) return;
  for (std::size_t i = 0; i < foot.cells.size(); ++i)
    foot.cells[i] = {from_double<fixed::Length>(p_SoleS.x() + sensor.cells_S_m[i].x()),
                     from_double<fixed::Length>(p_SoleS.y() + sensor.cells_S_m[i].y())};
}

// A torque scale in which the torque of all cells at full scale fits.
double cell_torque_scale_Nm(const robot::RobotModel& model, double force_scale_N) {
  double longest_m = 0.0;
  for (const robot::Foot& foot : model.feet)
    for (const robot::Cell& cell : foot.cells)
      longest_m =
          std::max({longest_m, std::abs(fixed::to_double(cell.x)), std::abs(fixed::to_double(cell.y))});
  return force_scale_N * longest_m;
}

}  // namespace

robot::Position fixed_position(const Vector3d& p_m) {
  return {from_double<fixed::Length>(p_m.x()), from_double<fixed::Length>(p_m.y()),
          from_double<fixed::Length>(p_m.z())};
}

fixed::Length body_height(const RobotDescription& robot) {
  double lowest = 0.0;
  double highest = 0.0;
  for (const sim_board::LinkDescription& link : robot.links) {
    for (const Vector3d& corner : corners_B(robot, link)) {
      lowest = std::min(lowest, corner.z());
      highest = std::max(highest, corner.z());
    }
  }
  return from_double<fixed::Length>(highest - lowest);
}

void set_feet(const RobotDescription& robot, robot::RobotModel& model, std::vector<InputError>& errors) {
  if (robot.left_ankle.has_value() != robot.right_ankle.has_value()) {
    errors.emplace_back(robot.file, (robot.left_ankle ? robot.left_ankle : robot.right_ankle)->line,
                        "a sensor in one ankle only", "one in each, or none");
    return;
  }
  model.ankle_kind = robot.ankle_kind();
  const auto set_foot = [&](hal::Side side, const std::optional<sim_board::AnkleSensorDescription>& sensor) {
    collect_error(errors, [&] {
      const auto ankle = find_ankle(robot, side);
      if (!ankle)
        throw InputError(robot.file, robot.line,
                         std::string("no leg on the ") + (side == hal::Side::kLeft ? "left" : "right"),
                         "joints with roles of a leg, such as ankle_roll, on both sides");
      set_sole(robot, *ankle, model.feet[side]);
      if (sensor) set_sensor(robot, *ankle, *sensor, model.feet[side]);
    });
  };
  set_foot(hal::Side::kLeft, robot.left_ankle);
  set_foot(hal::Side::kRight, robot.right_ankle);
  if (!model.measures_loads()) return;
  if (robot.left_ankle->force.resolution != robot.right_ankle->force.resolution ||
      robot.left_ankle->torque.resolution != robot.right_ankle->torque.resolution) {
    errors.emplace_back(robot.file, robot.right_ankle->line, "ankle sensors of different resolution",
                        "two of a kind");
  }
  const bool has_cells = model.ankle_kind == hal::AnkleKind::kPressureCells;
  const double force_N = robot.left_ankle->force.resolution * kFullScaleCounts * (has_cells ? 4.0 : 1.0);
  model.scales.ankle_force = from_double<fixed::Force>(force_N);
  model.scales.ankle_torque =
      from_double<fixed::Torque>(has_cells ? cell_torque_scale_Nm(model, force_N)
                                           : robot.left_ankle->torque.resolution * kFullScaleCounts);
}

}  // namespace koboshi::simulation
