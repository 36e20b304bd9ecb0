// What a user or a file gets wrong is said, instead of having no effect.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/import/kit_robot.h"
#include "tools/import/pipeline/import_robot.h"

namespace koboshi::tools {
namespace {

using testing::HasSubstr;

class ImportMistakes : public testing::Test {
 protected:
  ImportResult import(std::string urdf, const ImportDecisions& decisions,
                      const Interview::Ask& ask = {}) const {
    std::ofstream(file_, std::ios::binary) << urdf;
    return import_robot({.file = file_,
                         .servo_folder = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                         .decisions_source = "answers.yaml",
                         .decisions = decisions,
                         .ask = ask,
                         .output = temporary_.path / "out"});
  }
  std::string complaint(const std::string& urdf, const ImportDecisions& decisions = {}) const {
    try {
      static_cast<void>(import(urdf, decisions));
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }
  // The robot with a part of its text replaced.
  static std::string with(const std::string& part, const std::string& other) {
    std::string text = KitRobot().text();
    const std::size_t at = text.find(part);
    if (at == std::string::npos) throw std::logic_error("no " + part);
    return text.replace(at, part.size(), other);
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path file_ = temporary_.path / "kit.urdf";
};

TEST_F(ImportMistakes, AreDecisionsAboutWhatThereIsNot) {
  const std::string urdf = KitRobot().text();
  const std::vector<std::pair<std::function<void(ImportDecisions&)>, std::string>> mistakes{
      {[](auto& given) { given.servos["left_kne"] = "mx_28"; },
       "found left_kne in servos, expected a joint of robot.sdf; did you mean left_knee?"},
      {[](auto& given) { given.servos["j_l4"] = "mx_28"; },
       "found j_l4 in servos, expected a joint of robot.sdf, where it is left_knee"},
      {[](auto& given) { given.zero_deg["left_kne"] = 5; }, "found left_kne in zero_deg"},
      {[](auto& given) { given.locked_deg["left_knee"] = 5; },
       "found left_knee in locked_deg, expected a joint of the source"},
      {[](auto& given) { given.answers["upp"] = "z"; },
       "found upp in answers, expected the name of a question; did you mean up?"},
      {[](auto& given) { given.repairs["j_x7.speed"] = "keep"; }, "found j_x7 in repairs"},
      {[](auto& given) {
         given.joints = {{"left_kne", "j_l4"}};
       },
       "found left_kne in joints, expected the name of a role; did you mean left_knee?"},
      {[](auto& given) {
         given.joints = {{"left_knee", "j_l4"}, {"right_knee", "j_l4"}};
       },
       "found j_l4 in joints for left_knee and right_knee, expected one of them"}};
  for (const auto& [make, expected] : mistakes) {
    ImportDecisions decisions;
    make(decisions);
    EXPECT_THAT(complaint(urdf, decisions), HasSubstr(expected));
  }
  // Of another import of this robot: the question is not asked, and the repair not needed.
  ImportDecisions older;
  older.answers["one_motor"] = "no";
  older.repairs["l4.inertia"] = "keep";
  EXPECT_EQ(complaint(urdf, older), "none");
}

TEST_F(ImportMistakes, AreKindsOfJointsThatThereAreNot) {
  EXPECT_THAT(complaint(with("type=\"revolute\"", "type=\"Revolute\"")),
              HasSubstr("found a joint of the type Revolute, expected "));
  EXPECT_THAT(complaint(with("type=\"revolute\"", "type=\"prismatic\"")),
              testing::Not(HasSubstr("of the type")));
}

TEST_F(ImportMistakes, AreLimitsInDegrees) {
  EXPECT_THAT(
      complaint(with("lower=\"-1.5\" upper=\"1.5\"", "lower=\"-90\" upper=\"90\"")),
      HasSubstr("found a limit of -90 rad for j_n, expected at most 12.57 rad, two turns; did you mean -90 "
                "degrees?"));
  EXPECT_EQ(complaint(with("lower=\"-1.5\" upper=\"1.5\"", "lower=\"-6.28\" upper=\"6.28\"")), "none");
}

TEST_F(ImportMistakes, AreNotHingesWithoutARange) {
  for (const std::string limit : {"lower=\"-1.5\" upper=\"1.5\" ",
                                  "<limit lower=\"-1.5\" upper=\"1.5\" effort=\"10\" "
                                  "velocity=\"20\"/>"}) {
    const ImportResult result = import(with(limit, ""), {});
    EXPECT_EQ(result.robot.joints.size(), 20u);
    EXPECT_THAT(result.files.at("import.yaml"), HasSubstr("continuous_range_deg"));
  }
}

#ifdef KOBOSHI_HAS_MUJOCO
TEST_F(ImportMistakes, AreNamedByMuJoCoToTheEnd) {
  EXPECT_THAT(
      complaint("<mujoco><worldbody><body name=\"trunk\"><freejoint/><geom type=\"box\" size=\".1 .1 .1\"/>"
                "<body name=\"leg\"><joint name=\"hip\"/><inertial pos=\"0 0 0\" mass=\"0\" "
                "diaginertia=\"0 0 0\"/></body></body></worldbody></mujoco>\n"),
      HasSubstr("name = leg"));
}
#endif

// A person is asked again; a file is not.
TEST_F(ImportMistakes, AtTheTerminalAreAskedForAgain) {
  std::vector<std::string> texts;
  const ImportResult result = import(KitRobot().text(), {}, [&](const ImportQuestion& question) {
    if (question.name != "servo" && question.name != "friction") return std::string();
    texts.push_back(question.text);
    const bool is_again = texts.back().starts_with("found ");
    return question.name == "servo" ? std::string(is_again ? "mx_64_m6" : "mx64")
                                    : std::string(is_again ? "0.7" : "-3");
  });
  ASSERT_EQ(texts.size(), 4u);
  EXPECT_THAT(texts[1], HasSubstr("found mx64, expected "));
  EXPECT_THAT(texts[3], HasSubstr("found -3, expected a number from 0.05 to 5\n"));
  EXPECT_THAT(result.files.at("import.yaml"),
              testing::AllOf(HasSubstr("servo: mx_64_m6"), HasSubstr("friction: 0.7")));
  ImportDecisions decisions;
  decisions.answers["servo"] = "mx64";
  EXPECT_THAT(complaint(KitRobot().text(), decisions), HasSubstr("answers.yaml: found the answer mx64"));
}

}  // namespace
}  // namespace koboshi::tools
