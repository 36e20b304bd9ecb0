#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/edit/field_value.h"
#include "sim_board/description/edit/robot_text.h"
#include "sim_board/description/load.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::sim_board {
namespace {

const std::filesystem::path kRobotFile = KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf";

class ModelEditTest : public testing::Test {
 protected:
  std::string value(const std::string& path) { return find_field(document_, path).value.value_or("none"); }
  void set(const std::string& path, const std::string& text, Sides sides = Sides::kOne) {
    apply_settings(document_, {{path, text}}, sides);
  }
  // The text with the next place after `after` changed.
  std::string with(const std::string& after, const std::string& before, const std::string& text) const {
    std::string changed = first_;
    const std::size_t start = changed.find(after);
    EXPECT_NE(start, std::string::npos) << after;
    const std::size_t at = changed.find(before, start);
    EXPECT_NE(at, std::string::npos) << before;
    return changed.replace(at, before.size(), text);
  }

  XmlDocument document_{kRobotFile};
  const std::string first_ = document_.text();
};

TEST_F(ModelEditTest, ReadsValuesByShortPaths) {
  const std::map<std::string, std::string> values = {
      {"left_shank.mass", "0.05"},
      {"left_knee.axis", "0 1 0"},
      {"left_knee.xyz", "0 1 0"},
      {"left_knee.upper", "2.617994"},
      {"left_knee.servo", "krs_2552"},
      {"left_knee.node_id", "19"},
      {"left_knee.drive.zero_rad", "-1.308997"},
      {"trunk.position", "0 0 0.17"},
      {"trunk.com", "0 0 0.083"},
      {"trunk.inertial.pose", "0 0 0.083 0 0 0"},
      {"trunk.ixx", "5.2908e-04"},
      {"trunk.inertia.ixx", "5.2908e-04"},
      {"trunk.size", "0.06 0.08 0.106"},
      {"trunk.chest_cover.zoom", "0.001 0.001 0.001"},
      {"trunk.chest_cover.stl", "meshes/chest_cover.stl"},
      {"trunk.gyro.noise_density", "8.72665e-05"},
      {"left_foot.friction", "0.8"},
      {"left_foot.erp", "0.2"},
      {"left_foot.cfm", "0.0001"},
      {"left_foot.bounce", "0"},
      {"left_ankle_roll.left_ankle.force.range", "100"},
      {"krs_2552.supply_V", "7.5"},
      {"battery.open_circuit_V", "7.6"},
      {"link.left_shank.inertial.mass", "0.05"},
  };
  for (const auto& [path, expected] : values) EXPECT_EQ(value(path), expected) << path;
}

// A path that is shown is understood, and names that value alone.
TEST_F(ModelEditTest, FindsEachFieldByItsOwnPathAndKey) {
  std::set<std::string> paths;
  std::size_t count = 0;
  for (const ModelElement& element : model_elements(document_)) {
    for (const ModelField& field : model_fields(document_, element)) {
      ++count;
      EXPECT_TRUE(paths.insert(field.path).second) << field.path;
      if (count % 29 != 0) continue;  // each look-up reads a whole element
      EXPECT_EQ(find_field(document_, field.path).key(), field.key()) << field.path;
      EXPECT_EQ(find_field(document_, field.key()).path, field.path);
    }
  }
  EXPECT_GT(count, 2000U);
}

TEST_F(ModelEditTest, RefusesPathsThatNameNoneOrSeveralValues) {
  const std::map<std::string, std::string> errors = {
      {"left_shnk.mass", "left_shank"},
      {"left_shank.mas", "mass"},
      {"left_shank", "a value of it"},
      {"trunk.bias", "trunk.gyro.bias or trunk.accelerometer.bias"},
      {"trunk.zoom", "such as trunk.trunk_frame.scale"},
      {"", "then a value"},
      {"left_knee..axis", "a value of it"},
      {"trunk.mesh", "a value of it"},
  };
  for (const auto& [path, expected] : errors) {
    try {
      static_cast<void>(find_field(document_, path));
      ADD_FAILURE() << path;
    } catch (const InputError& error) {
      EXPECT_NE(error.expected().find(expected), std::string::npos) << path << ": " << error.what();
    }
  }
}

TEST_F(ModelEditTest, ChangesTheBytesOfOneValue) {
  set("left_shank.mass", "0.06");
  EXPECT_EQ(document_.text(), with("<link name=\"left_shank\"", "<mass>0.05<", "<mass>0.06<"));
  set("left_shank.mass", "0.05");
  EXPECT_EQ(document_.text(), first_);
  set("left_knee.noise_counts", "0.2");
  EXPECT_EQ(document_.text(),
            with("<joint name=\"left_knee\"", "noise_counts=\"0.1\"", "noise_counts=\"0.2\""));
}

// White space at the edge of a name is refused, so that a name set anew must not keep what was around it.
TEST_F(ModelEditTest, SetsANameWithoutTheBlanksAroundIt) {
  document_.replace_text(with("<joint name=\"left_knee\"", "<child>left_shank", "<child> left_shank"));
  set("left_knee.child", "left_shank");
  EXPECT_EQ(document_.text(), first_);
}

TEST_F(ModelEditTest, ConvertsUnits) {
  set("left_knee.upper", "140 deg");
  EXPECT_EQ(value("left_knee.upper"), "2.443461");
  set("left_shank.mass", "61.5 g");
  EXPECT_EQ(value("left_shank.mass"), "0.0615");
  set("left_shank.com", "1 0 -32.5 mm");
  EXPECT_EQ(value("left_shank.inertial.pose"), "0.001 0 -0.0325 0 0 0");
  set("left_shank.mass", "0.05 kg");
  EXPECT_EQ(value("left_shank.mass"), "0.05");
  EXPECT_THROW(set("left_shank.mass", "5 mm"), InputError);
  set("left_shank.mass", "45g");
  EXPECT_EQ(value("left_shank.mass"), "0.045");
  set("left_shank.mass", "0.0450kg");
  EXPECT_EQ(value("left_shank.mass"), "0.0450");
  set("left_shank.com", "1mm 0mm -30mm");
  EXPECT_EQ(value("left_shank.inertial.pose"), "0.001 0 -0.03 0 0 0");
  EXPECT_THROW(set("left_shank.com", "1mm 0mm -3cm"), InputError);
  const ModelField knee = find_field(document_, "left_knee.lower");
  EXPECT_EQ(shown_text(knee, "2.617994"), "150");
  EXPECT_EQ(shown_unit(knee), "deg");
}

TEST_F(ModelEditTest, KeepsTheOtherHalfOfAPose) {
  set("left_hip_yaw_link.horn.position", "0 0 0.04");
  EXPECT_EQ(document_.text(),
            with("<link name=\"left_hip_yaw_link\"", "0 0 0.0398 3.141593 0 0", "0 0 0.04 3.141593 0 0"));
  set("left_hip_yaw_link.horn.rotation", "0 90 0 deg");
  EXPECT_EQ(value("left_hip_yaw_link.horn.pose"), "0 0 0.04 0 1.570796 0");
}

TEST_F(ModelEditTest, AddsAndRemovesOptionalValues) {
  set("left_knee.position", "0 0 0.001");
  EXPECT_EQ(document_.text(), with("<joint name=\"left_knee\"", "revolute\">\n",
                                   "revolute\">\n      <pose>0 0 0.001 0 0 0</pose>\n"));
  set("left_knee.pose", "");
  EXPECT_EQ(document_.text(), first_);
  set("left_knee.offset_rad", "0.5 deg");
  EXPECT_NE(document_.text().find("bits=\"12\" noise_counts=\"0.1\" offset_rad=\"0.008727\""),
            std::string::npos);
  set("left_knee.offset_rad", "");
  EXPECT_EQ(document_.text(), first_);
  set("krs_2552.backlash_rad", "0.01");
  EXPECT_NE(document_.text().find("<velocity_gain_V_s_per_rad>0</velocity_gain_V_s_per_rad>\n"
                                  "      <backlash_rad>0.01</backlash_rad>\n"),
            std::string::npos);
  EXPECT_THROW(set("left_shank.mass", ""), InputError);
  EXPECT_THROW(set("left_foot.fdir1", ""), InputError);
}

TEST_F(ModelEditTest, AddsGroupsWhoseValuesComeTogether) {
  apply_settings(document_,
                 {{"krs_2552.stribeck.friction_Nm", "0.01"},
                  {"krs_2552.stribeck.speed_rad_per_s", "0.5"},
                  {"krs_2552.stribeck.exponent", "1"}},
                 Sides::kOne);
  EXPECT_NE(document_.text().find("<stribeck friction_Nm=\"0.01\" speed_rad_per_s=\"0.5\" exponent=\"1\"/>"),
            std::string::npos);
}

TEST_F(ModelEditTest, WritesNothingThatDoesNotLoad) {
  const std::vector<std::vector<ModelSetting>> refused = {
      {{"left_shank.mass", "-1"}},
      {{"left_shank.mass", "heavy"}},
      {{"left_shank.mass", "0.06"}, {"left_knee.axis", "0 1 1"}},
      {{"left_knee.axis", "0 1"}},
      {{"left_knee.lower", "3"}},
      {{"left_knee.node_id", "18"}},
      {{"left_knee.servo", "nothing"}},
      {{"left_knee.child", "nobody"}},
      {{"trunk.ixx", "1"}},
      {{"head.helmet.stl", "meshes/nobody.stl"}},
      {{"krs_2552.stribeck.exponent", "1"}},
      {{"left_knee.bits", "12.5"}},
  };
  for (const auto& settings : refused) {
    EXPECT_THROW(apply_settings(document_, settings, Sides::kOne), InputError) << settings.back().path;
    EXPECT_EQ(document_.text(), first_);
  }
}

TEST_F(ModelEditTest, SetsBothSides) {
  const auto both = [&](const std::string& path, const std::string& text, const std::string& other,
                        const std::string& expected) {
    const ModelField field = find_field(document_, path);
    const MirroredValue image = mirrored_value(document_, field, file_text(document_, field, text));
    EXPECT_EQ(image.field.key(), find_field(document_, other).key()) << path;
    EXPECT_EQ(image.value, expected) << path;
  };
  both("left_shank.mass", "0.06", "right_shank.mass", "0.06");
  both("left_hip_yaw_link.position", "0 0.031 0", "right_hip_yaw_link.position", "0 -0.031 0");
  both("right_shank.com", "0.001 0.002 -0.03", "left_shank.com", "0.001 -0.002 -0.03");
  both("left_shank.ixy", "1e-7", "right_shank.ixy", "-1e-7");
  both("left_shank.ixz", "1e-7", "right_shank.ixz", "1e-7");
  both("left_knee.upper", "140 deg", "right_knee.upper", "2.443461");
  both("left_hip_roll.lower", "-0.6", "right_hip_roll.upper", "0.6");  // turns the other way
  both("left_hip_roll.upper", "1.5", "right_hip_roll.lower", "-1.5");
  both("left_hip_roll.zero_rad", "-0.4", "right_hip_roll.zero_rad", "0.4");
  both("left_knee.zero_rad", "-1.3", "right_knee.zero_rad", "1.3");
  both("left_knee.axis", "0.0087265 0.99996 0", "right_knee.axis", "-0.0087265 0.99996 0");
  both("left_hip_roll.axis", "0.99996 0.0087265 0", "right_hip_roll.axis", "0.99996 -0.0087265 0");
  both("trunk.left_hip_yaw_servo.position", "0 0.031 0.0398", "trunk.right_hip_yaw_servo.position",
       "0 -0.031 0.0398");
  both("left_foot.friction", "0.6", "right_foot.friction", "0.6");
  both("left_hip_pitch.position", "0 0.001 0", "right_hip_pitch.position", "0 -0.001 0");
  set("left_hip_roll.lower", "-0.6", Sides::kBoth);
  EXPECT_EQ(value("left_hip_roll.lower"), "-0.6");
  EXPECT_EQ(value("right_hip_roll.upper"), "0.6");
  set("left_hip_pitch.position", "0 0.001 0", Sides::kBoth);
  EXPECT_EQ(value("right_hip_pitch.pose"), "0 -0.001 0 0 0 0");
  set("left_hip_pitch.pose", "", Sides::kBoth);
  set("left_hip_roll.lower", "-0.698132", Sides::kBoth);
  EXPECT_EQ(document_.text(), first_);
  for (const char* path : {"trunk.mass", "head_pan.upper", "left_knee.node_id", "left_knee.serial_number"}) {
    EXPECT_THROW(set(path, "1", Sides::kBoth), InputError) << path;
    EXPECT_FALSE(has_other_side(document_, find_field(document_, path))) << path;
  }
}

// The sides of a robot with names of its own, such as l_kny, are those of its roles; a mesh has the place
// that it has in its link.
TEST_F(ModelEditTest, FindsTheOtherSideByRole) {
  std::string text = first_;
  for (const auto& [name, own] : {std::pair{"left_shank", "shin_a"},
                                  {"right_shank", "shin_b"},
                                  {"left_knee", "kny_a"},
                                  {"right_knee", "kny_b"}}) {
    const std::string word = name;
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += std::strlen(own)) {
      const char after = text[at + word.size()];
      if (after == '"' || after == '<') text.replace(at, word.size(), own);
    }
  }
  document_ = XmlDocument(document_.source(), text);
  set("kny_a.role", "left_knee");
  set("kny_b.role", "right_knee");
  set("kny_a.upper", "140 deg", Sides::kBoth);
  EXPECT_EQ(value("kny_b.upper"), "2.443461");
  set("shin_b.com", "0.001 0.002 -0.03", Sides::kBoth);
  EXPECT_EQ(value("shin_a.com"), "0.001 -0.002 -0.03");
  set("kny_a.role", "left_wrist_pitch", Sides::kBoth);
  EXPECT_EQ(value("kny_b.role"), "right_wrist_pitch");
  // A stated mirror is enough.
  document_ = XmlDocument(document_.source(), text);
  apply_settings(document_, {{"kny_a.mirror", "kny_b"}, {"kny_b.mirror", "kny_a"}}, Sides::kOne);
  set("shin_a.mass", "0.06", Sides::kBoth);
  EXPECT_EQ(value("shin_b.mass"), "0.06");
  EXPECT_THROW(set("kny_a.mirror", "kny_b", Sides::kBoth), InputError);
}

bool same_numbers(const std::string& a, const std::string& b, double step) {
  std::istringstream one(a);
  std::istringstream other(b);
  std::string x;
  std::string y;
  while (one >> x) {
    if (!(other >> y)) return false;
    const auto p = koboshi::parse_number(x);
    const auto q = koboshi::parse_number(y);
    if (!p || !q ? x != y : std::abs(*p - *q) > step) return false;
  }
  return !(other >> y);
}

// The default robot is symmetric: the image of each left value is the right one. Poses of meshes that are
// symmetric themselves may differ by a turn.
TEST_F(ModelEditTest, MirrorsTheDefaultRobotOntoItself) {
  std::size_t compared = 0;
  for (const ModelElement& element : model_elements(document_)) {
    if (!element.name.starts_with("left_")) continue;
    for (const ModelField& field : model_fields(document_, element)) {
      if (!field.value || !has_other_side(document_, field)) continue;
      const bool is_mesh = field.steps.size() > 1 && field.steps[1].rule->name == "visual";
      if (is_mesh && field.steps.back().rule->name == "pose" && field.part != PosePart::kPosition) continue;
      const MirroredValue other = mirrored_value(document_, field, *field.value);
      EXPECT_TRUE(same_numbers(other.value, other.field.value.value_or("none"), 1e-6))
          << field.path << ": " << other.value << " for " << other.field.value.value_or("none");
      ++compared;
    }
  }
  EXPECT_GT(compared, 500U);
}

}  // namespace
}  // namespace koboshi::sim_board
