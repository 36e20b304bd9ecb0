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
      {[](auto& given) { given.locked_deg["l4"] = 5; },
       "found l4 in locked_deg, expected a joint of the source"},
      {[](auto& given) {
         given.limits_deg["left_kne"] = {0, 5};
       },
       "found left_kne in limits_deg, expected a joint of robot.sdf; did you mean left_knee?"},
      {[](auto& given) { given.repairs["j_x7.speed"] = "keep"; }, "found j_x7 in repairs"},
      {[](auto& given) { given.repairs["left_shank.inertai"] = "keep"; },
       "found left_shank.inertai in repairs, expected com, inertia or mass behind the dot; did you mean "
       "inertia?"},
      {[](auto& given) { given.repairs["j_l4.mass"] = "keep"; },
       "found j_l4.mass in repairs, expected limits, lower, speed or upper behind the dot"},
      {[](auto& given) { given.repairs["trunk"] = "keep"; },
       "found trunk in repairs, expected PART.WHAT, such as trunk.mass"},
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

// Nobody answers a dozen questions to learn that a name is misspelt.
TEST_F(ImportMistakes, AreNamedBeforeTheFirstQuestion) {
  const std::vector<std::function<void(ImportDecisions&)>> mistakes{
      [](auto& given) { given.servos["left_kne"] = "mx_28"; },
      [](auto& given) { given.zero_deg["left_kne"] = 5; },
      [](auto& given) {
        given.limits_deg["left_kne"] = {0, 5};
      },
      [](auto& given) { given.locked_deg["j_l44"] = 5; },
      [](auto& given) { given.answers["upp"] = "z"; },
      [](auto& given) { given.joints["left_knee"] = "j_l44"; },
      [](auto& given) { given.repairs["left_shnk.mass"] = "keep"; }};
  for (std::size_t i = 0; i < mistakes.size(); ++i) {
    ImportDecisions decisions;
    mistakes[i](decisions);
    int questions = 0;
    EXPECT_THROW(static_cast<void>(import(KitRobot().text(), decisions,
                                          [&](const ImportQuestion&) {
                                            ++questions;
                                            return std::string();
                                          })),
                 InputError)
        << i;
    EXPECT_EQ(questions, 0) << i;
  }
}

TEST_F(ImportMistakes, AreNamedWithTheirLine) {
  const std::filesystem::path map = temporary_.path / "import.yaml";
  const auto complaint_of = [&](const std::string& text) {
    std::ofstream(map, std::ios::binary) << "version: 1\n" << text;
    return complaint(KitRobot().text(), read_decisions(map));
  };
  EXPECT_THAT(complaint_of("servos:\n  left_knee: mx_28\n  left_kne: mx_28\n"),
              HasSubstr("import.yaml:4: found left_kne in servos"));
  EXPECT_THAT(complaint_of("answers:\n  servo: mx28\n"),
              HasSubstr("import.yaml:3: found the answer mx28 to the question servo"));
  EXPECT_THAT(complaint_of("joints:\n  left_knee: j_l44\n"),
              HasSubstr("import.yaml:3: found no joint j_l44"));
  EXPECT_THAT(complaint_of("servos:\n  j_l4: mx_28\n"), HasSubstr("import.yaml:3: found j_l4 in servos"));
  EXPECT_THAT(complaint_of("limits_deg:\n  j_l4: [0, 5]\n"), HasSubstr("import.yaml:3: found no joint j_l4"));
}

TEST_F(ImportMistakes, AreLocksOfOneSide) {
  const auto warnings = [&](const KitRobot& kit, const ImportDecisions& decisions) {
    std::string text;
    for (const std::string& line : import(kit.text(), decisions).report.warnings) text += line + "\n";
    return text;
  };
  ImportDecisions decisions;
  decisions.locked_deg["j_lc"] = 10;  // an elbow
  EXPECT_THAT(warnings({}, decisions),
              HasSubstr("j_rc is locked, too, because its mirror image j_lc is: a role needs both sides"));
  decisions.answers["lock_other_joints"] = "no";
  EXPECT_THAT(warnings({}, decisions), HasSubstr("j_lc is locked, while its mirror image j_rc has a drive"));
  decisions.locked_deg["j_rc"] = 10;
  EXPECT_THAT(warnings({}, decisions), testing::Not(HasSubstr("mirror image")));
  // Names without sides: by place and axis.
  std::string text = KitRobot().text();
  for (const auto& [name, other] : {std::pair("\"j_lc\"", "\"m7\""), std::pair("\"j_rc\"", "\"m12\"")})
    text.replace(text.find(name), std::string(name).size(), other);
  ImportDecisions by_place;
  by_place.locked_deg["m7"] = 10;
  by_place.answers["lock_other_joints"] = "no";
  EXPECT_THAT(import(text, by_place).report.warnings,
              testing::Contains(HasSubstr("m7 is locked, while its mirror image m12 has a drive")));
}

TEST_F(ImportMistakes, AreNamesThatAreTooLong) {
  const ImportResult result =
      import(with("robot name=\"kit\"", "robot name=\"kleiner Läufer aus Köln, zweiter Bau\""), {});
  EXPECT_THAT(
      result.report.warnings,
      testing::Contains(HasSubstr("the robot is named kleiner Läufer aus Köl instead of kleiner Läufer "
                                  "aus Köln, zweiter Bau, because its name has at most 24 bytes")));
  EXPECT_THAT(result.files.at("robot.sdf"), HasSubstr("<model name=\"kleiner Läufer aus Köl\""));
  ImportDecisions decisions;
  decisions.answers["name"] = "a name of more than 24 bytes";
  EXPECT_THAT(import(KitRobot().text(), decisions).report.warnings,
              testing::Contains(HasSubstr("instead of a name of more than 24 bytes")));
  EXPECT_THAT(import(KitRobot().text(), {}).report.warnings,
              testing::Not(testing::Contains(HasSubstr("is named"))));
}

TEST_F(ImportMistakes, AreNoPathsToTheSourceFromAFolderThatDoesNotExistYet) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(temporary_.path);
  const std::filesystem::path source = relative_source({.file = "kits/kit.urdf", .output = "new/robots/kit"});
  std::filesystem::create_directories("new/robots");
  const std::filesystem::path again = relative_source({.file = "kits/kit.urdf", .output = "new/robots/kit"});
  std::filesystem::current_path(before);
  EXPECT_EQ(source, "../../../kits/kit.urdf");
  EXPECT_EQ(again, source);
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

// A user who converts only the refused limits would get an ankle that turns by ten radians.
TEST_F(ImportMistakes, AreSmallLimitsInDegreesBesideLargeOnes) {
  std::string text = with("lower=\"-1.5\" upper=\"1.5\"", "lower=\"-90\" upper=\"90\"");
  const std::string head = "lower=\"-1\" upper=\"1\"";
  text.replace(text.find(head), head.size(), "lower=\"-10\" upper=\"10\"");
  EXPECT_THAT(complaint(text),
              HasSubstr("did you mean -90 degrees? The limits of j_h look like degrees, too"));
  EXPECT_THAT(
      import(with(head, "lower=\"-10\" upper=\"10\""), {}).report.warnings,
      testing::Contains(HasSubstr("j_h turns by up to 10 rad; if the file means degrees, write 0.1745")));
  EXPECT_THAT(import(with(head, "lower=\"-6.28\" upper=\"6.28\""), {}).report.warnings,
              testing::Not(testing::Contains(HasSubstr("degrees"))));
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
      complaint("<mujoco>\n\n\n<worldbody><body name=\"trunk\"><freejoint/><geom type=\"box\" size=\".1 .1 "
                ".1\"/>\n<body name=\"leg\"><joint name=\"hip\"/><inertial pos=\"0 0 0\" mass=\"0\" "
                "diaginertia=\"0 0 0\"/></body></body></worldbody></mujoco>\n"),
      testing::AllOf(HasSubstr("kit.urdf:5: "), HasSubstr("name = leg"), HasSubstr("line = 5")));
}
#endif

#ifdef KOBOSHI_HAS_MUJOCO
TEST_F(ImportMistakes, AreNoFurtherBodiesWithoutAWord) {
  const std::string leg =
      "<body name=\"leg\"><joint name=\"hip\" range=\"-90 90\" limited=\"true\"/><geom type=\"box\" "
      "size=\".1 "
      ".1 .1\"/></body>";
  const std::string others =
      "<body name=\"table\"><geom type=\"box\" size=\".1 .1 .1\"/></body><body name=\"ball\"><freejoint/>"
      "<geom type=\"sphere\" size=\".1\"/></body>";
  const auto warnings = [&](const std::string& beside) {
    return import("<mujoco><worldbody>" + beside +
                      "<body name=\"trunk\"><freejoint/><geom type=\"box\" size=\".1 .1 "
                      ".1\"/>" +
                      leg + "</body></worldbody></mujoco>\n",
                  {})
        .report.warnings;
  };
  EXPECT_THAT(warnings(others),
              testing::Contains("left out beside the robot trunk: table, ball, with all that they carry"));
  EXPECT_THAT(warnings(""), testing::Not(testing::Contains(HasSubstr("left out"))));
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
