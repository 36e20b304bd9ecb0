// The default robot: the paper's figures, and that its numbers agree with each other.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <set>

#include "sim_board/description/load.h"

namespace koboshi::sim_board {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;

const RobotDescription& default_robot() {
  static const RobotDescription robot =
      load_robot(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf");
  return robot;
}

const LinkDescription& link_of(int index) {
  return default_robot().links.at(static_cast<std::size_t>(index));
}

const JointDescription& joint_of(const std::string& name) {
  return default_robot().joints.at(static_cast<std::size_t>(default_robot().find_joint(name).value()));
}

// The box of uniform density that stands for a link's mass.
struct MassBox {
  Eigen::Vector3d p_LBox_m;
  Eigen::Vector3d size_m;
};

// The box with which the link collides, or around the servo of a link without one.
MassBox mass_box(const LinkDescription& link) {
  if (!link.collisions.empty()) {
    return {link.collisions[0].X_LG.translation(), link.collisions[0].size_m};
  }
  static const std::map<std::string, MassBox> kServos{
      {"neck", {{0, 0, 0.011}, {0.03, 0.024, 0.022}}},
      {"left_hip_yaw_link", {{-0.016, 0, 0.01}, {0.03, 0.024, 0.036}}},
      {"right_hip_yaw_link", {{-0.016, 0, 0.01}, {0.03, 0.024, 0.036}}},
      {"left_hip_roll_link", {{0.012, 0, 0.004}, {0.036, 0.024, 0.03}}},
      {"right_hip_roll_link", {{0.012, 0, 0.004}, {0.036, 0.024, 0.03}}},
      {"left_ankle_link", {{-0.01, 0, -0.008}, {0.036, 0.024, 0.022}}},
      {"right_ankle_link", {{-0.01, 0, -0.008}, {0.036, 0.024, 0.022}}},
      {"left_shoulder_link", {{0, -0.006, 0.004}, {0.036, 0.024, 0.03}}},
      {"right_shoulder_link", {{0, 0.006, 0.004}, {0.036, 0.024, 0.03}}},
  };
  return kServos.at(link.name);
}

Eigen::Vector3d corner_M(const LinkDescription& link, const BoxDescription& box, int corner) {
  const Eigen::Vector3d signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
  return link.X_ML * box.X_LG * (box.size_m.cwiseProduct(signs) / 2);
}

int joints_between(int a, int b) {
  const auto to_base = [](int link) {
    std::vector<int> path{link};
    for (bool climbs = true; climbs;) {
      climbs = false;
      for (const JointDescription& joint : default_robot().joints) {
        if (joint.child != path.back()) continue;
        path.push_back(joint.parent);
        climbs = true;
        break;
      }
    }
    return path;
  };
  const std::vector<int> from_a = to_base(a);
  const std::vector<int> from_b = to_base(b);
  for (std::size_t i = 0; i < from_a.size(); ++i) {
    for (std::size_t j = 0; j < from_b.size(); ++j) {
      if (from_a[i] == from_b[j]) return static_cast<int>(i + j);
    }
  }
  return -1;
}

TEST(DefaultRobot, HasTheMassAndSizeOfThePaper) {
  EXPECT_NEAR(default_robot().total_mass_kg(), 1.2, 0.001);
  double lowest_m = 1e9;
  double highest_m = -1e9;
  for (const LinkDescription& link : default_robot().links) {
    for (const BoxDescription& box : link.collisions) {
      for (int corner = 0; corner < 8; ++corner) {
        const double z_m = corner_M(link, box, corner).z();
        lowest_m = std::min(lowest_m, z_m);
        highest_m = std::max(highest_m, z_m);
      }
    }
  }
  EXPECT_NEAR(lowest_m, 0.0, 1e-9) << "soles on the ground";
  EXPECT_NEAR(highest_m - lowest_m, 0.38, 0.002);
}

TEST(DefaultRobot, HasTwentyHingesInTheOrderOfTheirNodes) {
  const std::vector<std::string> leg{"hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll"};
  const std::vector<std::string> arm{"shoulder_pitch", "shoulder_roll", "elbow"};
  std::vector<std::string> expected;
  for (const char* side : {"left_", "right_"}) {
    for (const std::string& name : leg) expected.push_back(side + name);
  }
  for (const char* side : {"left_", "right_"}) {
    for (const std::string& name : arm) expected.push_back(side + name);
  }
  expected.insert(expected.end(), {"head_pan", "head_tilt"});

  std::vector<std::string> names;
  std::set<std::uint32_t> serial_numbers;
  for (const JointDescription& joint : default_robot().joints) {
    EXPECT_EQ(joint.drive.node_id, 16 + names.size());
    EXPECT_EQ(joint.encoder.bits, 12);
    names.push_back(joint.name);
    serial_numbers.insert(joint.drive.serial_number);
  }
  EXPECT_EQ(names, expected);
  EXPECT_EQ(serial_numbers.size(), 20u);
  EXPECT_EQ(link_of(0).name, "trunk");
}

TEST(DefaultRobot, HasTheJointAxesOfTheFramesPage) {
  for (const JointDescription& joint : default_robot().joints) {
    const bool yaw = joint.name.ends_with("yaw") || joint.name.ends_with("pan");
    const Eigen::Vector3d axis = yaw                            ? Eigen::Vector3d::UnitZ()
                                 : joint.name.ends_with("roll") ? Eigen::Vector3d::UnitX()
                                                                : Eigen::Vector3d::UnitY();
    EXPECT_TRUE(joint.axis_M.isApprox(axis)) << joint.name;
  }
}

TEST(DefaultRobot, HasTheJointPositionsOfThePrototype) {
  const auto expect_at = [](const std::string& name, double y_m, double z_m) {
    EXPECT_TRUE(joint_of("left_" + name).p_MJ.isApprox(Eigen::Vector3d(0, y_m, z_m), 1e-9)) << name;
    EXPECT_TRUE(joint_of("right_" + name).p_MJ.isApprox(Eigen::Vector3d(0, -y_m, z_m), 1e-9)) << name;
  };
  for (const char* name : {"hip_yaw", "hip_roll", "hip_pitch"}) expect_at(name, 0.030, 0.170);
  expect_at("knee", 0.030, 0.105);
  for (const char* name : {"ankle_pitch", "ankle_roll"}) expect_at(name, 0.030, 0.040);
  for (const char* name : {"shoulder_pitch", "shoulder_roll"}) expect_at(name, 0.070, 0.290);
  expect_at("elbow", 0.070, 0.220);
}

TEST(DefaultRobot, MirrorsItsSides) {
  for (const JointDescription& left : default_robot().joints) {
    if (!left.name.starts_with("left_")) continue;
    const std::string right_name = "right_" + left.name.substr(5);
    const JointDescription& right = joint_of(right_name);
    const bool pitch = left.axis_M.y() > 0.5;
    EXPECT_EQ(right.lower_rad, pitch ? left.lower_rad : -left.upper_rad) << left.name;
    EXPECT_EQ(right.upper_rad, pitch ? left.upper_rad : -left.lower_rad) << left.name;
    EXPECT_EQ(right.drive.sign, pitch ? -left.drive.sign : left.drive.sign) << left.name;

    const LinkDescription& left_link = link_of(left.child);
    const LinkDescription& right_link = link_of(right.child);
    EXPECT_EQ(left_link.mass_kg, right_link.mass_kg);
    const Eigen::Vector3d com_left = left_link.X_ML * left_link.p_LCom_L;
    const Eigen::Vector3d com_right = right_link.X_ML * right_link.p_LCom_L;
    EXPECT_LT((com_left - com_right.cwiseProduct(Eigen::Vector3d(1, -1, 1))).norm(), 1e-9) << left_link.name;
  }
}

TEST(DefaultRobot, GivesEachLinkTheInertiaOfItsBox) {
  for (const LinkDescription& link : default_robot().links) {
    const MassBox box = mass_box(link);
    const Eigen::Vector3d squares = box.size_m.cwiseProduct(box.size_m);
    const Eigen::Vector3d moments = link.mass_kg / 12 * (Eigen::Vector3d::Constant(squares.sum()) - squares);
    EXPECT_LT((link.I_LCom_L - Eigen::Matrix3d(moments.asDiagonal())).norm(), 1e-3 * moments.norm())
        << link.name;
    EXPECT_LT((link.p_LCom_L - box.p_LBox_m).norm(), 1e-9) << link.name;
    EXPECT_GT(moments.minCoeff(), 5e-7) << link.name << " would be hard on the solver";
  }
}

TEST(DefaultRobot, HasNoOverlappingBoxesAtJointZero) {
  // Boxes are parallel to the axes there, so that a gap along one axis is enough.
  const auto& links = default_robot().links;
  int pairs = 0;
  for (int a = 0; a < static_cast<int>(links.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(links.size()); ++b) {
      if (joints_between(a, b) <= 1) continue;
      for (const BoxDescription& box_a : link_of(a).collisions) {
        for (const BoxDescription& box_b : link_of(b).collisions) {
          const Eigen::Vector3d distance =
              ((link_of(a).X_ML * box_a.X_LG).translation() - (link_of(b).X_ML * box_b.X_LG).translation())
                  .cwiseAbs();
          const Eigen::Vector3d gap_m = distance - (box_a.size_m + box_b.size_m) / 2;
          EXPECT_GT(gap_m.maxCoeff(), 0.001) << link_of(a).name << " and " << link_of(b).name;
          ++pairs;
        }
      }
    }
  }
  EXPECT_GT(pairs, 50);
}

TEST(DefaultRobot, CanFlexItsHipsBelowTheTrunk) {
  const LinkDescription& trunk = link_of(0);
  const LinkDescription& thigh = link_of(joint_of("left_hip_pitch").child);
  const BoxDescription& box = thigh.collisions.at(0);
  const double edge_x_m = trunk.collisions.at(0).size_m.x() / 2;
  const double edge_z_m = corner_M(trunk, trunk.collisions.at(0), 0).z() - 0.170;
  // Distance of the trunk's lower front edge from the thigh's centre line, which points forward and up.
  const double angle_rad = -joint_of("left_hip_pitch").lower_rad - 90 * kDegree_rad;
  const double distance_m = edge_z_m * std::cos(angle_rad) - edge_x_m * std::sin(angle_rad);
  EXPECT_GT(distance_m, box.size_m.x() / 2);
}

TEST(DefaultRobot, HasTheServoOfTheKondoClass) {
  for (const JointDescription& joint : default_robot().joints) {
    const ServoDescription& servo = joint.servo;
    EXPECT_NEAR(servo.torque_constant_Nm_per_A * servo.supply_V / servo.resistance_ohm, 1.373, 0.001);
    EXPECT_NEAR(servo.supply_V / servo.torque_constant_Nm_per_A, 7.48, 0.005);
    EXPECT_NEAR(servo.full_voltage_error_rad, 7 * kDegree_rad, 1e-5);
    EXPECT_EQ(servo.rotor_inertia_kg_m2, 0.00116);
  }
}

TEST(DefaultRobot, KeepsEveryShaftWithinOneTurnOfItsEncoder) {
  int shifted = 0;
  for (const JointDescription& joint : default_robot().joints) {
    for (const double limit_rad : {joint.lower_rad, joint.upper_rad}) {
      const double shaft_rad = joint.drive.sign * limit_rad + joint.drive.zero_rad;
      EXPECT_LE(std::abs(shaft_rad), 175.001 * kDegree_rad) << joint.name;
    }
    if (joint.drive.zero_rad != 0.0) ++shifted;
  }
  EXPECT_GE(shifted, 10) << "zeros that are not zero keep the firmware honest";
}

TEST(DefaultRobot, SinksLittleIntoTheGround) {
  const SurfaceDescription& sole =
      link_of(default_robot().find_link("left_foot").value()).collisions.at(0).surface;
  EXPECT_EQ(sole.friction, 0.8);
  EXPECT_EQ(sole.bounce, 0.0);
  // ODE's contact is a spring of ERP / (h CFM); a corner of a foot carries a quarter of the robot, at worst
  // all of it.
  const double stiffness_N_per_m =
      sole.error_reduction / (sole.reference_step_s * sole.constraint_force_mixing);
  EXPECT_LT(1.2 * 9.80665 / stiffness_N_per_m, 0.0001);
}

TEST(DefaultRobot, CarriesItsSensors) {
  const RobotDescription& robot = default_robot();
  ASSERT_TRUE(robot.imu && robot.left_ankle && robot.right_ankle);
  EXPECT_EQ(robot.imu->link, 0);
  EXPECT_LT((robot.imu->X_LS.translation() - robot.links[0].p_LCom_L).norm(), 0.01);
  EXPECT_NEAR(robot.imu->gyro.range, 1000 * kDegree_rad, 1e-4);
  EXPECT_NEAR(robot.imu->accelerometer.range, 4 * 9.80665, 1e-3);
  EXPECT_EQ(robot.imu->gyro.sample_period_s, 0.001);
  EXPECT_EQ(robot.joints.at(static_cast<std::size_t>(robot.left_ankle->joint)).name, "left_ankle_roll");
  EXPECT_EQ(robot.joints.at(static_cast<std::size_t>(robot.right_ankle->joint)).name, "right_ankle_roll");
  EXPECT_NEAR(robot.left_ankle->height_above_sole_m, 0.040, 1e-9);
  EXPECT_NEAR(robot.right_ankle->height_above_sole_m, 0.040, 1e-9);
}

TEST(DefaultRobot, ShowsEveryLinkInColour) {
  std::uintmax_t bytes = 0;
  std::set<std::filesystem::path> files;
  for (const LinkDescription& link : default_robot().links) {
    EXPECT_FALSE(link.meshes.empty()) << link.name;
    EXPECT_TRUE(link.visual_boxes.empty()) << link.name;
    for (const MeshDescription& mesh : link.meshes) {
      EXPECT_TRUE(mesh.colour.has_value()) << link.name << " " << mesh.name;
      EXPECT_EQ(mesh.scale, Eigen::Vector3d::Constant(0.001)) << "the files are in millimetres";
      files.insert(mesh.file);
    }
  }
  for (const auto& file : files) bytes += std::filesystem::file_size(file);
  EXPECT_LT(bytes, 1'500'000u);
}

}  // namespace
}  // namespace koboshi::sim_board
