#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {
namespace {

Eigen::Matrix3d box_inertia(double mass_kg, const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d squares = size_m.cwiseAbs2();
  return (mass_kg / 12.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares)).asDiagonal();
}

// Returns a box at p_MG in the model frame. The link's frame is at p_ML, parallel to the model frame.
LinkDescription box_link(const std::string& name, double mass_kg, const Eigen::Vector3d& p_ML,
                         const Eigen::Vector3d& p_MG, const Eigen::Vector3d& size_m) {
  LinkDescription link;
  link.name = name;
  link.X_ML = Eigen::Translation3d(p_ML);
  link.mass_kg = mass_kg;
  link.p_LCom_L = p_MG - p_ML;
  link.I_LCom_L = box_inertia(mass_kg, size_m);
  BoxDescription box;
  box.name = name;
  box.X_LG = Eigen::Translation3d(link.p_LCom_L);
  box.size_m = size_m;
  link.collisions.push_back(box);
  return link;
}

struct Builder {
  RobotDescription robot;

  // Adds a box on a hinge to `parent`. `middle` is the box's centre relative to the hinge.
  int add(const std::string& name, int parent, double mass_kg, const Eigen::Vector3d& p_MJ,
          const Eigen::Vector3d& axis, const Eigen::Vector3d& middle, const Eigen::Vector3d& size_m) {
    robot.links.push_back(box_link(name, mass_kg, p_MJ, p_MJ + middle, size_m));
    JointDescription joint;
    joint.name = name;
    joint.parent = parent;
    joint.child = static_cast<int>(robot.links.size()) - 1;
    joint.p_MJ = p_MJ;
    joint.axis_M = axis;
    joint.lower_rad = -2.0;
    joint.upper_rad = 2.0;
    robot.joints.push_back(joint);
    return joint.child;
  }

  void add_leg(const std::string& side, double y) {
    const Eigen::Vector3d X = Eigen::Vector3d::UnitX(), Y = Eigen::Vector3d::UnitY(),
                          Z = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d hip(0, y, 0), knee(0, y, -0.065), ankle(0, y, -0.13), none(0, 0, 0);
    const Eigen::Vector3d small(0.02, 0.02, 0.02), thin(0.025, 0.025, 0.045);
    const int yaw = add(side + "_hip_yaw", 0, 0.03, hip, Z, none, small);
    const int roll = add(side + "_hip_roll", yaw, 0.03, hip, X, none, small);
    const int thigh = add(side + "_thigh", roll, 0.09, hip, Y, {0, 0, -0.0325}, thin);
    const int shank = add(side + "_shank", thigh, 0.09, knee, Y, {0, 0, -0.0325}, thin);
    const int pitch = add(side + "_ankle", shank, 0.03, ankle, Y, none, small);
    add(side + "_foot", pitch, 0.06, ankle, X, {0.012, 0, -0.035}, {0.1, 0.056, 0.01});
  }

  void add_arm(const std::string& side, double y) {
    const Eigen::Vector3d shoulder(0, y, 0.12), elbow(0, y * 1.2, 0.05);
    const int pitch =
        add(side + "_shoulder", 0, 0.02, shoulder, Eigen::Vector3d::UnitY(), {0, 0, 0}, {0.02, 0.02, 0.02});
    const int upper = add(side + "_upper_arm", pitch, 0.05, shoulder, Eigen::Vector3d::UnitX(),
                          {0, y * 0.2, -0.035}, {0.02, 0.02, 0.05});
    add(side + "_forearm", upper, 0.04, elbow, Eigen::Vector3d::UnitY(), {0, 0, -0.047}, {0.02, 0.02, 0.08});
  }
};

}  // namespace

RobotDescription sample_box(double mass_kg, const Eigen::Vector3d& size_m) {
  RobotDescription robot;
  robot.name = "box";
  robot.links.push_back(box_link("box", mass_kg, {0, 0, 0}, {0, 0, 0}, size_m));
  return robot;
}

RobotDescription sample_hinge(const HingeRig& rig) {
  RobotDescription robot;
  robot.name = "hinge";
  LinkDescription link;
  link.mass_kg = 1.0;
  link.name = "bearing";
  robot.links.push_back(link);
  link.name = "arm";
  link.mass_kg = rig.mass_kg;
  link.I_LCom_L = rig.inertia_kg_m2 * Eigen::Matrix3d::Identity();
  link.p_LCom_L = {rig.arm_m, 0.0, 0.0};
  robot.links.push_back(link);
  JointDescription joint;
  joint.name = "hinge";
  joint.parent = 0;
  joint.child = 1;
  joint.axis_M = rig.axis;
  joint.lower_rad = rig.lower_rad;
  joint.upper_rad = rig.upper_rad;
  robot.joints.push_back(joint);
  return robot;
}

RobotDescription sample_humanoid() {
  Builder builder;
  builder.robot.name = "humanoid";
  builder.robot.links.push_back(box_link("trunk", 0.3, {0, 0, 0}, {0, 0, 0.07}, {0.06, 0.08, 0.1}));
  builder.add_leg("left", 0.03);
  builder.add_leg("right", -0.03);
  builder.add_arm("left", 0.06);
  builder.add_arm("right", -0.06);
  const int pan =
      builder.add("pan", 0, 0.02, {0, 0, 0.13}, Eigen::Vector3d::UnitZ(), {0, 0, 0}, {0.02, 0.02, 0.02});
  builder.add("tilt", pan, 0.04, {0, 0, 0.14}, Eigen::Vector3d::UnitY(), {0, 0, 0.03}, {0.04, 0.04, 0.05});
  return builder.robot;
}

}  // namespace koboshi::sim_board
