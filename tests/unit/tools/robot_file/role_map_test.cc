#include "tools/robot_file/map/role_map.h"

#include <set>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "sim_board/description/schema/roles.h"
#include "simulation/model/robot_model.h"
#include "tests/unit/tools/robot_file/planted_robot.h"

namespace koboshi::tools {
namespace {

using sim_board::RobotDescription;

// The default robot whose joints have names that say nothing.
class RoleMapTest : public PlantedRobotTest {
 protected:
  static constexpr int kFirst = 100;  // so that no name begins with another one

  RoleMapTest() : original_(sim_board::load_robot(file_, text_)) {
    for (std::size_t i = 0; i < original_.joints.size(); ++i) {
      const std::string name = "\"" + original_.joints[i].name + "\"";
      for (std::size_t at = 0; (at = text_.find(name, at)) != std::string::npos;)
        text_.replace(at, name.size(), "\"" + anonymous(i) + "\"");
    }
  }

  static std::string anonymous(std::size_t joint) { return "m" + std::to_string(kFirst + joint); }
  RobotDescription robot() const { return sim_board::load_robot(file_, text_); }
  // The robot after `model map --write`.
  RobotDescription mapped(const RoleMap& map) {
    XmlDocument document(file_, text_);
    sim_board::apply_settings(document, role_settings(robot(), map), sim_board::Sides::kOne);
    text_ = document.text();
    return robot();
  }

  RobotDescription original_;
};

TEST_F(RoleMapTest, FindsAllRolesWithoutNames) {
  const RoleMap map = propose_roles(robot());
  for (std::size_t i = 0; i < original_.joints.size(); ++i) {
    EXPECT_EQ(map.joints[i].role, original_.joints[i].name);
    EXPECT_EQ(static_cast<int>(map.joints[i].mirror), original_.mirror_of(static_cast<int>(i)));
  }
  EXPECT_EQ(original_.links.at(static_cast<std::size_t>(map.feet[0].value())).name, "left_foot");
  EXPECT_EQ(original_.links.at(static_cast<std::size_t>(map.feet[1].value())).name, "right_foot");
}

TEST_F(RoleMapTest, MakesTheSameModelAsNames) {
  EXPECT_FALSE(simulation::find_model_errors(robot()).empty());
  const RobotDescription written = mapped(propose_roles(robot()));
  EXPECT_EQ(simulation::make_robot_model(written), simulation::make_robot_model(original_));
  EXPECT_EQ(written.find_joint("left_knee"), original_.find_joint("left_knee"));
  EXPECT_EQ(written.find_joints("knee").size(), 2U);
  // The file states everything now, so that nothing is left to write.
  EXPECT_TRUE(role_settings(written, propose_roles(written)).empty());
}

TEST_F(RoleMapTest, CorrectionsMoveRoles) {
  const auto knee = static_cast<std::size_t>(original_.find_joint("left_knee").value());
  const auto pitch = static_cast<std::size_t>(original_.find_joint("left_hip_pitch").value());
  RoleMap map = propose_roles(robot());
  correct_role(robot(), "left_knee=" + anonymous(pitch), map);
  EXPECT_EQ(map.joints[pitch].role, "left_knee");
  EXPECT_EQ(map.joints[pitch].mirror, static_cast<std::size_t>(original_.find_joint("right_knee").value()));
  EXPECT_EQ(map.joints[knee].role, "");
  EXPECT_EQ(map.joints[knee].mirror, knee);
  correct_role(robot(), "left_knee=", map);
  EXPECT_EQ(map.joints[pitch].role, "");
  EXPECT_THROW(correct_role(robot(), "left_kne=" + anonymous(knee), map), InputError);
  EXPECT_THROW(correct_role(robot(), "left_knee=nobody", map), InputError);
  EXPECT_THROW(correct_role(robot(), "left_knee", map), InputError);
}

TEST_F(RoleMapTest, StatedRolesHavePrecedence) {
  RoleMap map = propose_roles(robot());
  const auto pan = static_cast<std::size_t>(original_.find_joint("head_pan").value());
  correct_role(robot(), "waist_yaw=" + anonymous(pan), map);
  const RobotDescription written = mapped(map);
  EXPECT_EQ(propose_roles(written).joints[pan].role, "waist_yaw");
}

TEST_F(RoleMapTest, PrintsTheMakersServos) {
  plant("<joint name=\"" + anonymous(0), "<koboshi:drive",
        "<koboshi:maker servo_id=\"7\" sign=\"-1\" zero_ticks=\"512\" "
        "ticks_per_turn=\"1228.8\"/>\n<koboshi:drive");
  EXPECT_NE(role_map_text(robot(), propose_roles(robot()))
                .find("servo_id: 7, sign: -1, zero_ticks: 512, ticks_per_turn: 1228.8}"),
            std::string::npos);
}

TEST_F(PlantedRobotTest, ARoleBelongsToOneJoint) {
  plant("<joint name=\"left_elbow\"", "<koboshi:drive",
        "<koboshi:role>left_knee</koboshi:role>\n<koboshi:drive");
  const ModelReport report = check();
  EXPECT_TRUE(has(report, "R031"));
  EXPECT_THROW(sim_board::load_robot(file_, text_), InputError);
}

TEST_F(PlantedRobotTest, MirrorsAreMutual) {
  plant("<joint name=\"left_elbow\"", "<koboshi:drive",
        "<koboshi:mirror>right_knee</koboshi:mirror>\n<koboshi:drive");
  EXPECT_TRUE(has(check(), "R031"));
  plant("<joint name=\"left_elbow\"", ">right_knee<", ">nobody<");
  EXPECT_TRUE(has(check(), "R031"));
}

TEST_F(PlantedRobotTest, AServoOfTheMakerBelongsToOneJoint) {
  plant("<joint name=\"left_elbow\"", "<koboshi:drive", "<koboshi:maker servo_id=\"7\"/>\n<koboshi:drive");
  EXPECT_TRUE(check().findings.empty());
  plant("<joint name=\"left_knee\"", "<koboshi:drive", "<koboshi:maker servo_id=\"7\"/>\n<koboshi:drive");
  EXPECT_TRUE(has(check(), "R031"));
}

TEST(RoleNames, HaveTheirOtherSide) {
  const std::set<std::string> names(sim_board::role_names().begin(), sim_board::role_names().end());
  EXPECT_EQ(names.size(), sim_board::role_names().size());
  for (const std::string& name : names) EXPECT_TRUE(names.contains(sim_board::other_side(name))) << name;
}

}  // namespace
}  // namespace koboshi::tools
