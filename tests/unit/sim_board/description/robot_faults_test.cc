#include "sim_board/description/robot_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/xml/xml_draft.h"
#include "sim_board/description/load.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tests/unit/sim_board/description/small_robot.h"

namespace koboshi::sim_board {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<RobotFaultKind> kinds_in(const std::string& text, bool is_hand_broken = false) {
  const XmlDraft draft("FILE", text, sdf_rule());
  const XmlNode model = draft.root().child("model");
  std::vector<XmlNode> broken;
  if (is_hand_broken) broken.push_back(model.child("link"));
  std::vector<RobotFaultKind> kinds;
  for (const RobotFault& fault : find_robot_faults(model, ".", broken)) kinds.push_back(fault.kind);
  return kinds;
}

TEST(FindRobotFaults, FindsNothingInASoundRobot) { EXPECT_THAT(kinds_in(kSmallRobot), IsEmpty()); }

std::string many_faults() {
  std::string text = with("<izz>4e-4</izz>", "<izz>9e-4</izz>");
  text = replaced(text, "<xyz>1 0 0", "<xyz>0.9 0 0");
  text = replaced(text, "<lower>-1", "<lower>3");
  text = replaced(text, "0 1 0</fdir1>", "0 0 0</fdir1>");
  text = replaced(text, "<collision name",
                  "<visual name='v'><geometry><mesh><uri>no.stl</uri></mesh></geometry></visual>"
                  "<collision name");
  return replaced(text, "type=\"small\"", "type=\"smal\"");
}

TEST(FindRobotFaults, FindsAllInOneRun) {
  using enum RobotFaultKind;
  EXPECT_THAT(kinds_in(many_faults()), ElementsAre(kInertia, kShape, kMesh, kAxis, kLimits, kReference));
}

TEST(FindRobotFaults, LeavesOutWhatIsBroken) {
  using enum RobotFaultKind;
  EXPECT_THAT(kinds_in(many_faults(), true), ElementsAre(kAxis, kLimits, kReference));
}

TEST(FindRobotFaults, SaysNothingOfATreeWhoseLinksAreNotThere) {
  using enum RobotFaultKind;
  EXPECT_THAT(kinds_in(with("<child>hand", "<child>hnad")), ElementsAre(kReference));
}

TEST(LoadRobot, ReadsATextThatIsNoFile) {
  EXPECT_EQ(load_robot("no/such/file.sdf", kSmallRobot).name, "arm");
  EXPECT_THROW(load_robot("no/such/file.sdf", many_faults()), InputError);
}

}  // namespace
}  // namespace koboshi::sim_board
