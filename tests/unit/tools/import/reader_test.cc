#include <gtest/gtest.h>

#include <fstream>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/import/kit_robot.h"
#include "tools/import/read/mjcf_reader.h"
#include "tools/import/read/robot_reader.h"
#include "tools/import/read/sdf_reader.h"
#include "tools/import/read/urdf_reader.h"

namespace koboshi::tools {
namespace {

ImportedRobot read(const std::string& text, ImportReport& report) {
  ImportedRobot robot = read_urdf("robot.urdf", text, report);
  static_cast<void>(root_link(robot));
  return robot;
}

std::string error_of(const std::string& text) {
  ImportReport report;
  try {
    static_cast<void>(read(text, report));
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(UrdfReader, ReadsLinksAndJoints) {
  ImportReport report;
  const ImportedRobot robot = read(KitRobot{}.text(), report);
  EXPECT_EQ(robot.name, "kit");
  EXPECT_EQ(robot.joints.size(), 21U);
  EXPECT_TRUE(report.ignored.empty());
  const ImportedJoint& knee = robot.joints[static_cast<std::size_t>(robot.find_joint("j_l4").value())];
  EXPECT_EQ(knee.axis_L, Eigen::Vector3d::UnitY());
  EXPECT_EQ(knee.X_PL.translation(), Eigen::Vector3d(0.0, 0.0, -0.08));
  EXPECT_EQ(knee.upper_rad, 2.0);
}

TEST(UrdfReader, NamesWhatItIgnores) {
  ImportReport report;
  static_cast<void>(read("<robot><link name='a'/>\n<gazebo/><gazebo/></robot>", report));
  ASSERT_EQ(report.ignored.size(), 1U);
  EXPECT_EQ(report.ignored.front(), "<gazebo> in <robot> (2 times, first in line 2)");
}

TEST(UrdfReader, NamesTheLineOfAFault) {
  EXPECT_EQ(
      error_of("<robot>\n<link name='a'/><link/></robot>").find("robot.urdf:2: found <link> without name"),
      0U);
  EXPECT_EQ(error_of("<robot><link name='a'/>\n<link name='a'/></robot>"),
            "robot.urdf:2: found a second link a, expected a name of its own");
  EXPECT_EQ(error_of("<robot><link name='a'><inertial><mass value='heavy'/>"
                     "<inertia ixx='1' iyy='1' izz='1'/></inertial></link></robot>"),
            "robot.urdf:1: found mass = heavy, expected a number");
  EXPECT_EQ(error_of("<robot><link name='a'/>\n<joint name='j' type='fixed'><parent link='a'/><child "
                     "link='b'/></joint></robot>"),
            "robot.urdf:2: found link b, expected the name of a <link>");
  EXPECT_EQ(error_of("<robot><link name='a'/>\n<link name='b'/></robot>"),
            "robot.urdf:2: found link b, no joint's child, expected only a to be that");
}

// Exporters write huge numbers or inf where a joint has no limit.
TEST(UrdfReader, ReadsLimitsThatAreNone) {
  for (const char* none : {"1e16", "inf"}) {
    ImportReport report;
    const std::string text =
        "<robot><link name='a'/><link name='b'/><joint name='j' type='revolute'>"
        "<parent link='a'/><child link='b'/><limit lower='-1' upper='" +
        std::string(none) + "' velocity='" + none + "' effort='2'/></joint></robot>";
    const ImportedRobot robot = read(text, report);
    EXPECT_EQ(robot.joints.front().kind, JointKind::kContinuous);
    EXPECT_EQ(robot.joints.front().speed_rad_per_s, 0.0);
    EXPECT_EQ(robot.joints.front().effort_Nm, 2.0);
  }
}

TEST(UrdfReader, NamesClosedLoops) {
  const std::string links = "<robot><link name='a'/><link name='b'/><link name='c'/>\n";
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child) {
    return "<joint name='" + name + "' type='fixed'><parent link='" + parent + "'/><child link='" + child +
           "'/></joint>\n";
  };
  EXPECT_EQ(error_of(links + joint("x", "a", "b") + joint("y", "b", "c") + joint("z", "c", "b") + "</robot>"),
            "robot.urdf:4: found a closed loop: b moved by x and by z, expected one joint for each link; "
            "remove the joint "
            "that closes the loop");
  EXPECT_EQ(error_of(links + joint("x", "c", "b") + joint("y", "b", "c") + "</robot>"),
            "robot.urdf:1: found a closed loop of links: c, b, c, expected a tree of joints");
}

std::string sdf(const std::string& content) {
  return "<sdf version='1.6'><model name='m'>" + content + "</model></sdf>";
}

// The link's frame becomes that of its joint, and the axis of SDF 1.6 may be given in the model's axes.
TEST(SdfReader, ResolvesFrames) {
  ImportReport report;
  const ImportedRobot robot = read_sdf(
      "m.sdf",
      sdf("<link name='a'><pose>0 0 1 0 0 0</pose></link>"
          "<link name='b'><pose>0 0 2 0 0 1.5707963267948966</pose><inertial><mass>2</mass></inertial></link>"
          "<joint name='j' type='revolute'><pose>0.5 0 0 0 0 0</pose><parent>a</parent><child>b</child>"
          "<axis><xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame>"
          "<limit><lower>-1</lower><upper>1</upper></limit></axis></joint>"),
      report);
  ASSERT_EQ(robot.joints.size(), 1U);
  EXPECT_LT((robot.joints[0].X_PL.translation() - Eigen::Vector3d(0.0, 0.5, 1.0)).norm(), 1e-12);
  EXPECT_LT((robot.joints[0].axis_L - Eigen::Vector3d(0.0, -1.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((robot.links[1].p_LCom_L - Eigen::Vector3d(-0.5, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_EQ(robot.joints[0].kind, JointKind::kHinge);
}

TEST(SdfReader, NamesRingsAndMissingFrames) {
  ImportReport report;
  EXPECT_THROW(static_cast<void>(read_sdf("m.sdf",
                                          sdf("<link name='a'><pose relative_to='b'/></link>"
                                              "<link name='b'><pose relative_to='a'/></link>"),
                                          report)),
               InputError);
  EXPECT_THROW(static_cast<void>(read_sdf(
                   "m.sdf", sdf("<link name='a'><pose relative_to='c'>0 0 0 0 0 0</pose></link>"), report)),
               InputError);
  const ImportedRobot robot =
      read_sdf("m.sdf",
               sdf("<link name='a'/><link name='b'/><joint name='j' type='revolute'>"
                   "<parent>a</parent><child>b</child><axis><limit><lower>-1e16</lower>"
                   "<upper>1e16</upper></limit></axis></joint>"),
               report);
  EXPECT_EQ(robot.joints[0].kind, JointKind::kContinuous);
}

#ifdef KOBOSHI_HAS_MUJOCO
TEST(MjcfReader, ReadsBodiesAndJoints) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "robot.xml";
  std::ofstream(file)
      << R"(<mujoco model="m"><compiler angle="degree"/><worldbody><geom type="plane" size="1 1 1"/>
<body name="a" pos="0 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="2"/>
<body name="b" pos="0 0 -0.2"><joint name="j" type="hinge" axis="0 2 0" pos="0 0 0.05" range="-30 60" limited="true"/>
<joint name="k" type="hinge" axis="1 0 0"/><geom type="capsule" size="0.02 0.05" mass="0.5"/></body></body></worldbody>
<actuator><motor joint="j" gear="3" forcelimited="true" forcerange="-2 2"/></actuator></mujoco>)";
  ImportReport report;
  const ImportedRobot robot = read_foreign_robot(file, report);
  EXPECT_EQ(robot.name, "m");
  ASSERT_EQ(robot.links.size(), 3U);
  ASSERT_EQ(robot.joints.size(), 2U);
  EXPECT_EQ(robot.links[0].mass_kg, 2.0);
  EXPECT_LT((robot.joints[0].X_PL.translation() - Eigen::Vector3d(0.0, 0.0, -0.15)).norm(), 1e-12);
  EXPECT_LT((robot.joints[1].X_PL.translation() - Eigen::Vector3d(0.0, 0.0, -0.05)).norm(), 1e-12);
  EXPECT_NEAR(*robot.joints[0].upper_rad, 1.0472, 1e-4);
  EXPECT_EQ(robot.joints[0].effort_Nm, 6.0);
  EXPECT_EQ(robot.joints[1].kind, JointKind::kContinuous);
  EXPECT_FALSE(robot.joints[1].has_actuator);
  EXPECT_EQ(robot.links[2].collisions.size(), 1U);

  std::ofstream(file) << "<mujoco>\n<worldbody>\n<bogus/></worldbody></mujoco>";
  try {
    static_cast<void>(read_foreign_robot(file, report));
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.line(), 3) << error.what();
  }
}

// What MuJoCo has added since 2.2 is of no matter to the import, or has a counterpart.
TEST(MjcfReader, ReadsModelsOfNewerVersions) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "robot.xml";
  std::ofstream(folder.path / "parts.xml")
      << "<mujocoinclude><default><default class='strong'><joint armature='0.02' frictionloss='0.3' "
         "actuatorfrcrange='-45 45'/><position inheritrange='1' kv='5'/></default></default></mujocoinclude>";
  std::ofstream(file) << R"(<mujoco model="new"><compiler angle="radian"/>
<option integrator="implicitfast"><flag eulerdamp="disable"/></option>
<include file="parts.xml"/>
<worldbody><light type="spot" bulbradius="1"/>
<body name="a" gravcomp="0"><freejoint align="false"/><geom size="0.1" mass="3"/><site name="imu_site" pos="0 0 0.1"/>
<frame pos="0 0.2 0"><body name="b" pos="0 0 -0.1"><joint name="j" class="strong" range="-1 2" ref="0.5"/>
<geom size="0.05" mass="1" contype="0" conaffinity="0" group="3"/></body></frame>
</body></worldbody>
<actuator><position class="strong" joint="j" dampratio="1"/></actuator>
<sensor><contact name="c" geom1="g" geom2="h"/></sensor>
<keyframe><key qpos="1 2 3"/></keyframe>
</mujoco>)";
  ImportReport report;
  const ImportedRobot robot = read_foreign_robot(file, report);
  const auto index = robot.find_joint("j");
  ASSERT_TRUE(index);
  const ImportedJoint& joint = robot.joints[static_cast<std::size_t>(*index)];
  EXPECT_EQ(joint.effort_Nm, 45.0);
  EXPECT_EQ(joint.line, 6);
  EXPECT_EQ(robot.links[0].line, 5);
  EXPECT_EQ(joint.rotor_inertia_kg_m2, 0.02);
  EXPECT_EQ(joint.coulomb_friction_Nm, 0.3);
  EXPECT_TRUE(joint.has_actuator);
  // A range without `limited` limits since MuJoCo 3, and counts from the pose of the model.
  ASSERT_EQ(joint.kind, JointKind::kHinge);
  EXPECT_NEAR(*joint.lower_rad, -1.5, 1e-12);
  EXPECT_NEAR(*joint.upper_rad, 1.5, 1e-12);
  const std::vector<Eigen::Isometry3d> X_ML = link_poses(robot);
  EXPECT_LT(
      (X_ML[static_cast<std::size_t>(joint.child)].translation() - Eigen::Vector3d(0.0, 0.2, -0.1)).norm(),
      1e-12);
  // What is hidden is there to touch, also where the model lists the pairs that may.
  EXPECT_EQ(robot.links[static_cast<std::size_t>(joint.child)].collisions.size(), 1U);
  ASSERT_EQ(robot.links[0].frames.size(), 1U);
  EXPECT_EQ(robot.links[0].frames[0].name, "imu_site");
}

TEST(MjcfReader, NamesTheLineOfTheSource) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "robot.xml";
  const auto line_of = [&](const std::string& text) {
    std::ofstream(file) << text;
    ImportReport report;
    try {
      static_cast<void>(read_foreign_robot(file, report));
    } catch (const InputError& error) {
      return error.line();
    }
    return -1;
  };
  EXPECT_EQ(
      line_of("<mujoco>\n<option/>\n<worldbody>\n<body>\n<attach model='m'/></body></worldbody></mujoco>"),
      5);
  EXPECT_EQ(line_of("<mujoco>\n\n<sensor>\n</sensor><worldbody><body>\n\n<geom size='x'/>"
                    "</body></worldbody></mujoco>"),
            6);
  EXPECT_EQ(line_of("<mujoco>\n<include file='robot.xml'/><include file='robot.xml'/></mujoco>"), 2);
  EXPECT_EQ(line_of("<mujoco><worldbody><body><frame>\n<joint/></frame></body></worldbody></mujoco>"), 2);
}

TEST(MjcfReader, ReadsGearsAndLoops) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "robot.xml";
  std::ofstream(file) << R"(<mujoco><worldbody>
<body name="a"><freejoint/><geom size="0.1"/><site name="s"/>
<body name="b"><joint name="driven" range="-1 1"/><geom size="0.05"/>
<body name="c"><joint name="k"/><geom size="0.01"/><site name="t"/></body></body>
<body name="d"><joint name="drive"/><geom size="0.01"/></body></body></worldbody>
<actuator><motor joint="drive" ctrllimited="true" ctrlrange="-7 7" gear="2"/></actuator>
<equality><joint joint1="driven" joint2="drive" polycoef="0 -0.8 0 0 0"/><connect site1="s" site2="t"/>
</equality></mujoco>)";
  ImportReport report;
  const ImportedRobot robot = read_foreign_robot(file, report);
  const ImportedJoint& driven = robot.joints.at(static_cast<std::size_t>(robot.find_joint("driven").value()));
  EXPECT_EQ(driven.mimics, "drive");
  EXPECT_EQ(driven.mimic_ratio, -0.8);
  EXPECT_EQ(robot.joints.at(static_cast<std::size_t>(robot.find_joint("drive").value())).effort_Nm, 14.0);
  ASSERT_EQ(robot.loops.size(), 1U);
  EXPECT_EQ(robot.links[static_cast<std::size_t>(robot.loops[0].one)].name, "a");
  EXPECT_EQ(robot.links[static_cast<std::size_t>(robot.loops[0].other)].name, "c");
}
#else
TEST(MjcfReader, IsNotInThisBuild) {
  ImportReport report;
  EXPECT_THROW(static_cast<void>(read_mjcf("m.xml", "", report)), InputError);
}
#endif

TEST(RobotReader, NamesTheLineOfMalformedXmlAndOfXacroValues) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "kit.urdf";
  ImportReport report;
  for (const char* text : {"<robot name='kit'>\n\n<link name='a'></robot>\n",
                           "<robot name='kit'>\n\n<link name=\"${side}_leg\"/></robot>\n"}) {
    test::write_file(file, text);
    try {
      static_cast<void>(read_foreign_robot(file, report));
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_EQ(error.line(), 3) << error.what();
    }
  }
}

TEST(RobotReader, SaysHowToExpandXacro) {
  ImportReport report;
  try {
    static_cast<void>(read_foreign_robot("robot.urdf.xacro", report));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "robot.urdf.xacro: found a file for xacro, expected a URDF; expand it with: xacro "
                 "robot.urdf.xacro > robot.urdf");
  }
}

// A macro in a file of another name; an expanded file keeps the declaration of the namespace.
TEST(RobotReader, FindsXacroInAFileOfAnyName) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "kit.urdf";
  const std::string head = "<robot name='kit' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n";
  ImportReport report;
  test::write_file(file, head + "<link name='a'/>\n</robot>\n");
  EXPECT_EQ(read_foreign_robot(file, report).links.size(), 1u);
  test::write_file(file, head + "<link name='a'/>\n<xacro:leg side='left'/>\n</robot>\n");
  try {
    static_cast<void>(read_foreign_robot(file, report));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.line(), 3);
    EXPECT_EQ(error.found(), "a file for xacro");
    EXPECT_EQ(error.expected(), "a URDF; expand it with: xacro " + file.string() + " > " +
                                    (folder.path / "kit_expanded.urdf").string());
  }
}

}  // namespace
}  // namespace koboshi::tools
