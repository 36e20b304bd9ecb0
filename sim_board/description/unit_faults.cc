// Values that no robot of this size has: most often a number in another unit.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "base/text/text.h"
#include "base/text/units.h"
#include "sim_board/description/fault_list.h"
#include "sim_board/description/schema/sdf_version.h"

namespace koboshi::sim_board {
namespace {

// Density of osmium, the densest of all materials.
constexpr double kMaxDensity_kg_per_m3 = 22590.0;
// More than a robot's links side by side: with all its links in a row, no frame is further from another.
constexpr double kMaxReach = 3.0;
// A joint turns by less than a turn, and rotations of frames are written within one.
constexpr double kMaxAngle_rad = 2.0 * std::numbers::pi;
// 573 revolutions per minute. The fastest servos and actuators of legged robots reach 40 rad/s.
constexpr double kMaxSpeed_rad_per_s = 60.0;

// The limit of protective extra-low voltage, DC (IEC 61140).
constexpr double kMaxSupply_V = 120.0;
constexpr double kMaxMotorTime_s = 1.0;
// Gyroscopes of the MPU-6050 class have 20 deg/s, accelerometers 0.05 g.
constexpr double kMaxGyroBias_rad_per_s = 1.75;
constexpr double kMaxAccelerometerBias_m_per_s2 = 4.9;

Eigen::Isometry3d pose_of(const XmlNode& node) {
  const auto pose = node.find("pose");
  if (!pose) return Eigen::Isometry3d::Identity();
  const std::vector<double> p = pose->numbers();
  return Eigen::Translation3d(p[0], p[1], p[2]) * Eigen::AngleAxisd(p[5], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(p[4], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(p[3], Eigen::Vector3d::UnitX());
}

// The box around the boxes of a link. Empty if it has none, or one whose frame is another link's.
Eigen::AlignedBox3d extent_of(const XmlNode& link) {
  Eigen::AlignedBox3d extent;
  for (const char* kind : {"collision", "visual"}) {
    for (const XmlNode& shape : link.children(kind)) {
      const auto box = shape.child("geometry").find("box");
      const auto pose = shape.find("pose");
      if (!box) continue;
      if (pose && find_pose_frame(*pose)) return {};
      const std::vector<double> size = box->child("size").numbers();
      const Eigen::AlignedBox3d own(Eigen::Vector3d(-size[0], -size[1], -size[2]) / 2,
                                    Eigen::Vector3d(size[0], size[1], size[2]) / 2);
      for (int corner = 0; corner < 8; ++corner)
        extent.extend(pose_of(shape) * own.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
    }
  }
  return extent;
}

class UnitCheck {
 public:
  explicit UnitCheck(FaultList& faults) : faults_(faults) {}

  // `values`: those that were written together. `limit`: the largest magnitude that is plausible.
  void check(const XmlNode& node, const std::vector<double>& values, const std::string& unit,
             const std::string& owner, double limit, const std::string& why) {
    const auto is_plausible = [limit](double value) { return std::abs(value) <= limit; };
    if (std::ranges::all_of(values, is_plausible)) return;
    std::string found;
    for (const double value : values) found += number_text(value) + " ";
    std::string expected = "at most " + rounded(limit) + " " + unit + " (" + why + ")";
    const std::string question = unit_question(values, unit, is_plausible);
    if (!question.empty()) expected += "; " + question;
    faults_.add(RobotFaultKind::kUnit, node, found + unit + " for " + owner, expected);
  }

 private:
  static std::string rounded(double value) {
    const double step = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
    const double shown = std::round(value / step) * step;
    return number_text(std::round(shown * 1e9) / 1e9);
  }

  FaultList& faults_;
};

void check_mass(const XmlNode& link, UnitCheck& check) {
  const Eigen::AlignedBox3d extent = extent_of(link);
  if (extent.isEmpty()) return;
  const XmlNode mass = link.child("inertial").child("mass");
  check.check(mass, mass.numbers(), "kg", link.attribute("name"), kMaxDensity_kg_per_m3 * extent.volume(),
              "osmium in its boxes");
}

// `reach_m`: the largest distance between frames that is plausible; none: the robot has too few boxes.
void check_pose(const XmlNode& node, const std::string& owner, std::optional<double> reach_m,
                UnitCheck& check) {
  const auto pose = node.find("pose");
  if (!pose) return;
  const std::vector<double> values = pose->numbers();
  if (reach_m)
    check.check(*pose, {values.begin(), values.begin() + 3}, "m", "the position of " + owner, *reach_m,
                "three times the length of all links");
  check.check(*pose, {values.begin() + 3, values.end()}, "rad", "the rotation of " + owner,
              kMaxAngle_rad * (1 + 1e-6), "a turn");
}

void check_joint(const XmlNode& joint, UnitCheck& check) {
  const std::string name = joint.attribute("name");
  const XmlNode limit = joint.child("axis").child("limit");
  for (const char* end : {"lower", "upper"}) {
    const XmlNode node = limit.child(end);
    check.check(node, node.numbers(), "rad", std::string(end) + " of " + name, kMaxAngle_rad * (1 + 1e-6),
                "a turn");
  }
  const XmlNode speed = limit.child("velocity");
  check.check(speed, speed.numbers(), "rad/s", "the speed of " + name, kMaxSpeed_rad_per_s, "a fast servo");
}

// Limits of a servo, from its own motor where that says more than a number.
void check_servo(const XmlNode& type, UnitCheck& check) {
  const std::string name = type.attribute("name");
  const auto one = [&](const char* key, const char* unit, double limit, const char* why) {
    const XmlNode node = type.child(key);
    check.check(node, node.numbers(), unit, std::string(key) + " of " + name, limit, why);
  };
  const double torque_constant = type.number("torque_constant_Nm_per_A");
  const double resistance_ohm = type.number("resistance_ohm");
  one("supply_V", "V", kMaxSupply_V, "a low voltage");
  one("full_voltage_error_rad", "rad", 0.5 * std::numbers::pi, "a quarter of a turn");
  one("coulomb_friction_Nm", "N m", torque_constant * type.number("supply_V") / resistance_ohm,
      "its stall torque");
  // Without load the motor reaches its speed within its time constant J R / k^2.
  one("rotor_inertia_kg_m2", "kg m^2", kMaxMotorTime_s * torque_constant * torque_constant / resistance_ohm,
      "a motor that takes a second to its speed");
}

void check_sensor(const XmlNode& sensor, const std::string& owner, UnitCheck& check) {
  const auto bias = [&](const char* channel, const char* unit, double limit, const char* why) {
    const auto node = sensor.find(channel);
    if (!node) return;
    const XmlNode value = node->child("bias");
    check.check(value, value.numbers(), unit, "the bias of " + sensor.attribute("name") + " of " + owner,
                limit, why);
  };
  bias("koboshi:gyro", "rad/s", kMaxGyroBias_rad_per_s, "five times that of a cheap gyroscope");
  bias("koboshi:accelerometer", "m/s^2", kMaxAccelerometerBias_m_per_s2, "half of gravity");
}

// A moment of inertia whose radius of gyration is longer than the robot.
void check_inertia(const XmlNode& link, double reach_m, UnitCheck& check) {
  const XmlNode inertial = link.child("inertial");
  const double limit = inertial.number("mass") * reach_m * reach_m;
  for (const char* moment : {"ixx", "iyy", "izz"}) {
    const XmlNode node = inertial.child("inertia").child(moment);
    check.check(node, node.numbers(), "kg m^2", std::string(moment) + " of " + link.attribute("name"), limit,
                "its mass at three times the length of all links");
  }
}

}  // namespace

void find_unit_faults(const XmlNode& model, FaultList& faults) {
  UnitCheck check(faults);
  const std::vector<XmlNode> links = faults.sound_children(model, "link");
  double length_m = 0.0;
  std::size_t with_boxes = 0;
  for (const XmlNode& link : links) {
    const Eigen::AlignedBox3d extent = extent_of(link);
    if (extent.isEmpty()) continue;
    length_m += extent.diagonal().norm();
    ++with_boxes;
  }
  const std::optional<double> reach_m =
      2 * with_boxes >= links.size() && with_boxes > 1 ? std::optional(kMaxReach * length_m) : std::nullopt;
  for (const XmlNode& link : links) {
    const std::string name = link.attribute("name");
    check_mass(link, check);
    check_pose(link, name, reach_m, check);
    check_pose(link.child("inertial"), "the centre of mass of " + name, reach_m, check);
    if (reach_m) check_inertia(link, *reach_m, check);
    for (const char* part : {"collision", "visual", "sensor"})
      for (const XmlNode& node : link.children(part))
        check_pose(node, node.attribute("name") + " of " + name, reach_m, check);
    for (const XmlNode& node : link.children("sensor")) check_sensor(node, name, check);
  }
  for (const XmlNode& type : faults.sound_children(model, "koboshi:servo_type")) check_servo(type, check);
  if (const auto battery = model.find("koboshi:battery")) {
    check.check(*battery, {battery->attribute_number("open_circuit_V", 0.0)}, "V", "the battery",
                kMaxSupply_V, "a low voltage");
  }
  for (const XmlNode& joint : faults.sound_children(model, "joint")) {
    check_pose(joint, joint.attribute("name"), reach_m, check);
    check_joint(joint, check);
  }
  for (const XmlNode& frame : faults.sound_children(model, "frame"))
    check_pose(frame, frame.attribute("name"), reach_m, check);
}

}  // namespace koboshi::sim_board
