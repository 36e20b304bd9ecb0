#include "tools/robot_file/check/reader_findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "base/edit/xml_document.h"
#include "base/xml/xml_check.h"
#include "base/xml/xml_draft.h"
#include "sim_board/description/robot_faults.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tests/unit/tools/robot_file/planted_robot.h"

namespace koboshi::tools {
namespace {

using ReaderFindingsTest = PlantedRobotTest;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kShank = "<link name=\"left_shank\">";
const char* const kKnee = "<joint name=\"left_knee\"";

// A planted fault: `before`, the first text of that kind behind `after`, becomes `text`.
struct Plant {
  const char* code;
  const char* after;
  const char* before;
  const char* text;
  const char* repair;   // part of the proposed repair
  const char* element;  // where it is
  const char* key;
};

// The repair can be made without a choice: a text editor's edits make it.
const std::vector<Plant> kRepaired{
    {"R011", kShank, "<mass>0.05", "<mass>-0.05", "Write 0.05.", "left_shank", "link/inertial/mass"},
    {"R011", kShank, "<mass>0.05", "<mass>0,05", "Write 0.05.", "left_shank", "link/inertial/mass"},
    {"R011", kShank, "<mass>0.05", "<mass>0", "right_shank has a mass of 0.05.", "left_shank",
     "link/inertial/mass"},
    {"R012", kShank, "<izz>4.6167e-06", "<izz>4.6167e-05", "The nearest inertia of a rigid body has ixx",
     "left_shank", "link/inertial/inertia"},
    {"R013", kKnee, "<lower>0.000000</lower><upper>2.617994", "<lower>2.617994</lower><upper>0.0",
     "Exchange them: lower 0.0, upper 2.617994.", "left_knee", "joint/axis/limit"},
    {"R014", kKnee, "<xyz>0 1 0", "<xyz>0 0.8 0", "in this direction is 0 1 0.", "left_knee",
     "joint/axis/xyz"},
    {"R015", "<visual name=\"chest_cover\">", "chest_cover.stl", "chest_cuver.stl",
     "The nearest file is meshes/chest_cover.stl.", "trunk", "link/visual/geometry/mesh/uri"},
    {"R016", kKnee, "bits=\"12\"", "bits=\"32\"", "Write 24.", "left_knee", "joint/koboshi:encoder@bits"},
    {"R016", kKnee, "type=\"revolute\"", "type=\"hinge\"", "Write revolute.", "left_knee", "joint@type"},
    {"R016", kShank, "<pose>0 0 -0.033", "<pose>0 0 -0,033", "Write 0 0 -0.033 0 0 0.", "left_shank",
     "link/inertial/pose"},
    {"R017", kShank, "<inertial>", "<colour>red</colour><inertial>", "Remove it.", "left_shank",
     "link/colour"},
    {"R017", kKnee, "noise_counts=", "noise_count=", "Write noise_counts.", "left_knee",
     "joint/koboshi:encoder@noise_count"},
    {"R019", kShank, "<mass>0.05</mass>", "<mass>0.05</mass><mass>0.06</mass>", "Remove one of the two.",
     "left_shank", "link/inertial/mass"},
    {"R020", "<visual name=\"chest_stripe\">", "chest_stripe", "chest_cover", "such as chest_cover_2.",
     "trunk", "link/visual@name"},
    {"R020", "<visual name=\"chest_stripe\">", "chest_stripe", "chest::stripe", "such as chest_stripe.",
     "trunk", "link/visual@name"},
    {"R021", kKnee, "<child>left_shank", "<child>left_shnak", "The nearest is left_shank.", "left_knee",
     "joint/child"},
    {"R021", kKnee, "type=\"krs_2552\"", "type=\"krs_2525\"", "The nearest is krs_2552.", "left_knee",
     "joint/koboshi:servo@type"},
    {"R021", kShank, "relative_to=\"left_thigh\"", "relative_to=\"left_tigh\"", "The nearest is left_thigh.",
     "left_shank", "link/pose@relative_to"},
    {"R023", kKnee, "node_id=\"19\"", "node_id=\"18\"", "The next free node id is 19.", "left_knee",
     "joint/koboshi:drive@node_id"},
    {"R024", kKnee, "zero_rad=\"-1.308997\"", "zero_rad=\"3.1\"", "With zero_rad = -1.309 ", "left_knee",
     "joint/koboshi:drive@zero_rad"},
    {"R025", "type=\"imu\"", "</update_rate>", "</update_rate><koboshi:jitter_s>0.01</koboshi:jitter_s>",
     "microseconds", "trunk", "link/sensor/koboshi:jitter_s"},
    {"R025", "<koboshi:gyro>", "<resolution>0.000532632", "<resolution>0.0000532632",
     "a resolution of 0.000532632", "trunk", "link/sensor/koboshi:gyro/resolution"},
    {"R025", "<koboshi:torque>", "<delay_s>0.001", "<delay_s>0.002", "Set both to one value, such as 0.001.",
     "left_ankle_roll", "joint/sensor/koboshi:torque/delay_s"},
    {"R016", "<joint name=\"head_pan", "head_pan", "head_pan ", "Write head_pan.", "head_pan ", "joint@name"},
    {"R016", kKnee, "<child>left_shank", "<child> left_shank", "Write left_shank.", "left_knee",
     "joint/child"},
    {"R027", "<visual name=\"chest_cover\">", "<geometry>", "<geometry><box><size>1 1 1</size></box>",
     "Remove the box or the mesh.", "trunk", "link/visual/geometry"},
};

// Only people know the repair.
const std::vector<Plant> kUnrepaired{
    {"R001", kShank, "relative_to=\"left_thigh\"", "relative_to=\"left_shank\"", "", "", ""},
    {"R001", kShank, "</mass>", "</mas>", "", "", ""},
    {"R011", "<link name=\"trunk\">", "<mass>0.36", "<mass>0", "from CAD", "trunk", "link/inertial/mass"},
    {"R012", kShank, "<ixx>1.2083e-05</ixx><iyy>1.0167e-05</iyy><izz>4.6167e-06</izz>",
     "<ixx>0</ixx><iyy>0</iyy><izz>0</izz>", "uniform box", "left_shank", "link/inertial/inertia"},
    {"R013", kKnee, "<upper>2.617994", "<upper>0", "Set a range", "left_knee", "joint/axis/limit"},
    {"R014", kKnee, "<xyz>0 1 0", "<xyz>0 0 0", "Give a direction", "left_knee", "joint/axis/xyz"},
    {"R018", kKnee, " bits=\"12\"", "", "Add bits: a turn has 2^bits counts, a whole number from 8 to 24.",
     "left_knee", "joint/koboshi:encoder"},
    {"R018", kShank, "<mass>0.05</mass>", "",
     "Add <mass>: mass of the link, a number from 1e-06 to 1000 in kg.", "left_shank", "link/inertial"},
    {"R030", kShank, "<mass>0.05", "<mass>45", "in the unit of the file", "left_shank", "link/inertial/mass"},
    {"R030", kKnee, "<upper>2.617994", "<upper>150", "in the unit of the file", "left_knee",
     "joint/axis/limit/upper"},
    {"R020", "<joint name=\"head_pan\"", "head_pan", "head::pan", "such as head_pan.", "head::pan",
     "joint@name"},
    {"R020", "<model name=\"koboshi\"", "koboshi", "ko::boshi", "such as ko_boshi.", "", "@name"},
    {"R022", kKnee, "<child>left_shank", "<child>left_thigh", "<child>", "", ""},
    {"R026", "<koboshi:servo_type", "derating_C=\"80\"", "derating_C=\"120\"", "data sheet", "krs_2552",
     "koboshi:servo_type/winding"},
};

std::string repaired_text(const std::string& text, const std::vector<ModelEdit>& edits) {
  XmlDocument document("robot.sdf", text);
  for (const ModelEdit& edit : edits) {
    if (edit.value && edit.attribute.empty()) {
      document.set_text(edit.place, *edit.value, XmlDocument::Blanks::kGo);
    } else if (edit.value) {
      document.set_attribute(edit.place, edit.attribute, *edit.value);
    } else if (!edit.attribute.empty()) {
      document.erase_attribute(edit.place, edit.attribute);
    } else {
      document.erase_element(edit.place);
    }
  }
  return document.text();
}

// The reader's findings before it loads the robot.
std::vector<std::string> faults_in(const std::filesystem::path& file, const std::string& text) {
  const XmlDraft draft(file, text, sim_board::sdf_rule());
  std::vector<std::string> found;
  for (const XmlFault& fault : find_xml_faults(draft.root(), sim_board::sdf_rule()))
    found.push_back(fault.found);
  if (!found.empty()) return found;
  for (const sim_board::RobotFault& fault :
       sim_board::find_robot_faults(draft.root().child("model"), file.parent_path()))
    found.push_back(fault.found);
  return found;
}

TEST_F(ReaderFindingsTest, FindEachFaultWithCodePlaceAndARepairThatRepairs) {
  const std::string original = text_;
  for (const Plant& one : kRepaired) {
    SCOPED_TRACE(std::string(one.code) + " " + one.text);
    text_ = original;
    plant(one.after, one.before, one.text);
    const ReaderFindings reading = find_reader_findings(file_, text_);
    ASSERT_EQ(reading.findings.size(), 1U);
    const ModelFinding& finding = reading.findings.front();
    EXPECT_EQ(finding.code, one.code) << finding.found;
    EXPECT_EQ(finding.severity, simulation::Severity::kError);
    EXPECT_THAT(finding.repair, HasSubstr(one.repair));
    EXPECT_EQ(finding.element, one.element);
    EXPECT_EQ(finding.key, one.key);
    EXPECT_NEAR(finding.line, line_, 2);  // of the element, which may begin above the planted value
    EXPECT_TRUE(reading.robot.has_value());
    ASSERT_FALSE(finding.edits.empty());
    EXPECT_THAT(faults_in(file_, repaired_text(text_, finding.edits)), IsEmpty());
  }
}

TEST_F(ReaderFindingsTest, FindFaultsThatOnlyPeopleCanRepair) {
  const std::string original = text_;
  for (const Plant& one : kUnrepaired) {
    SCOPED_TRACE(std::string(one.code) + " " + one.text);
    text_ = original;
    plant(one.after, one.before, one.text);
    const ReaderFindings reading = find_reader_findings(file_, text_);
    ASSERT_FALSE(reading.findings.empty());
    for (const ModelFinding& finding : reading.findings) {
      EXPECT_EQ(finding.code, one.code) << finding.found;
      EXPECT_TRUE(finding.edits.empty());
      EXPECT_THAT(finding.repair, HasSubstr(one.repair));
    }
    const bool has_place = one.key[0] != '\0';
    EXPECT_TRUE(!has_place || reading.findings.front().element == one.element);
    EXPECT_TRUE(!has_place || reading.findings.front().key == one.key) << reading.findings.front().key;
    EXPECT_FALSE(reading.robot.has_value());
  }
}

TEST_F(ReaderFindingsTest, HaveAnExampleOfEachCode) {
  std::set<std::string> codes;
  for (const auto* plants : {&kRepaired, &kUnrepaired})
    for (const Plant& one : *plants) codes.insert(one.code);
  EXPECT_THAT(codes,
              ElementsAre("R001", "R011", "R012", "R013", "R014", "R015", "R016", "R017", "R018", "R019",
                          "R020", "R021", "R022", "R023", "R024", "R025", "R026", "R027", "R030"));
}

TEST_F(ReaderFindingsTest, GiveAllInOneRunAndLetTheOtherChecksGoOn) {
  plant(kShank, "<mass>0.05", "<mass>-0.05");
  plant(kKnee, "<xyz>0 1 0", "<xyz>0 0.8 0");
  plant("<visual name=\"chest_cover\">", "chest_cover.stl", "chest_cuver.stl");
  plant("<link name=\"right_foot\">", "<mass>0.051", "<mass>0.06");  // not that of the left foot: R003
  plant("<koboshi:servo_type", "<torque_constant_Nm_per_A>1.0027", "<torque_constant_Nm_per_A>0.1");  // R009
  const ModelReport report = check();
  std::multiset<std::string> codes;
  for (const ModelFinding& one : report.findings) codes.insert(one.code);
  EXPECT_EQ(codes, (std::multiset<std::string>{"R003", "R009", "R011", "R014", "R015"}));
  EXPECT_TRUE(report.is_repaired);
  EXPECT_NEAR(report.robot->total_mass_kg(), 1.2, 0.1);
}

TEST_F(ReaderFindingsTest, GoOnWithTheRestOfTheFileWhereALinkIsBroken) {
  plant(kShank, "<mass>0.05</mass>", "");
  plant(kShank, "<izz>4.6167e-06", "<izz>4.6167e-03");  // in the broken link: cannot be judged
  plant(kKnee, "<xyz>0 1 0", "<xyz>0 0.8 0");
  plant("<link name=\"right_shank\">", "<izz>4.6167e-06", "<izz>4.6167e-05");
  std::multiset<std::string> codes;
  for (const ModelFinding& one : check().findings) codes.insert(one.code);
  EXPECT_EQ(codes, (std::multiset<std::string>{"R012", "R014", "R018"}));
}

TEST_F(ReaderFindingsTest, CorrectAMisspeltNameInsteadOfMissingIt) {
  plant(kShank, "<mass>0.05</mass>", "<mas>-0.05</mas>");
  std::vector<std::string> codes;
  for (const ModelFinding& one : check().findings) codes.push_back(one.code);
  EXPECT_THAT(codes, ElementsAre("R017", "R011"));  // and its content is looked at
}

}  // namespace
}  // namespace koboshi::tools
